#pragma once

#include "saccade/core/camera.hpp"
#include "saccade/core/lens_distortion.hpp"

namespace saccade {

/// A camera as it is, with its lens: normalised coordinates are distorted before `camera` takes them to pixels.
struct DistortedCamera {
  PinholeCamera camera;
  LensDistortion distortion;
};

/// The pinhole camera C, of the same size, in which a source shows the images of `real` without distortion.
///
/// Its view is widened just so far that it holds all pixels of `real` (a barrel lens sees more than a pinhole of the
/// same focal length does: 4.6 % of the pixels on the Kinect of 7-Scenes), never narrowed. Pixels stay square if they
/// were. Throws std::invalid_argument for a camera without a size or focal lengths.
[[nodiscard]] PinholeCamera idealCameraOf(const DistortedCamera& real);

}  // namespace saccade
