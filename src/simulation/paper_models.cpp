#include <algorithm>

#include "simulation/mesh_shapes.hpp"
#include "simulation/model_parts.hpp"
#include "simulation/object_models.hpp"
#include "simulation/print_paint.hpp"
#include "simulation/texture_paint.hpp"

namespace saccade {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kQuarterTurn = 3.14159265358979 / 2;

Vector3d asDouble(const Vector3f& v) {
  return v.cast<double>();
}

/// Lays what stands with its front towards +y on its back, so that the front looks up.
Pose onItsBack(const Vector3f& size_m) {
  Pose lie = Pose::Identity();
  lie.translation() = Vector3d(0, asDouble(size_m).z() / 2, asDouble(size_m).y() / 2);
  lie.rotate(Eigen::AngleAxisd(kQuarterTurn, Vector3d::UnitX()));
  return lie;
}

/// Tilts a model that stands backwards, the foot of its back on the ground.
void lean(ObjectModel& model, double angle) {
  Pose tilt = Pose::Identity();
  tilt.rotate(Eigen::AngleAxisd(angle, Vector3d::UnitX()));
  model.transform(tilt);
  float lowest = model.parts.front().mesh.vertices.front().z();
  for (const ObjectModel::Part& part : model.parts) {
    for (const Vector3f& p : part.mesh.vertices) lowest = std::min(lowest, p.z());
  }
  model.transform(Pose(Eigen::Translation3d(0, 0, -static_cast<double>(lowest))));
}

/// Adds a standing block of paper, moved to `pose`, with `print` on its front.
void addPrinted(ObjectModel& model, const Vector3f& size_m, const cv::Mat3b& print, float gloss, const Pose& pose,
                RandomStream& random) {
  Mesh block = makeTiledBox(size_m, 0.3f, kObjectCell_m);
  Mesh front = makeRectangle({size_m.x() / 2, size_m.y() / 2 + 3e-4f, size_m.z()}, {-size_m.x(), 0, 0},
                             {0, 0, -size_m.z()}, kObjectCell_m);
  block.transform(pose);
  front.transform(pose);
  model.add(std::move(block), paintMottled({215, 222, 225}, 3, random), 0.02f);
  model.add(std::move(front), print, gloss);
}

}  // namespace

ObjectModel makeSheet(RandomStream& random) {
  static const Vector3f kFormats[] = {{0.21f, 0, 0.297f}, {0.148f, 0, 0.21f}, {0.105f, 0, 0.21f}, {0.297f, 0, 0.21f}};
  Vector3f paper = kFormats[random.below(4)];
  paper.y() = size(random, 0.0012, 0.002);
  ObjectModel model{"sheet", {}};
  const cv::Mat3b print = paintDocument(asDouble(paper).x(), asDouble(paper).z(), random);
  addPrinted(model, paper, print, 0.03f, onItsBack(paper), random);
  return model;
}

ObjectModel makeMagazine(RandomStream& random) {
  const float width = size(random, 0.17, 0.23), thick = size(random, 0.003, 0.009);
  const Vector3f paper{width, thick, size(random, 1.25, 1.4) * width};
  ObjectModel model{"magazine", {}};
  const cv::Mat3b print = paintCover(asDouble(paper).x(), asDouble(paper).z(), random);
  addPrinted(model, paper, print, 0.15f, onItsBack(paper), random);
  return model;
}

ObjectModel makeFolder(RandomStream& random) {
  const Vector3f cover{size(random, 0.22, 0.25), size(random, 0.004, 0.02), size(random, 0.3, 0.32)};
  ObjectModel model{"folder", {}};
  const float gloss = size(random, 0.02, 0.2);
  model.add(makeTiledBox(cover, 0.3f, kObjectCell_m), paintMottled(anyColor(random), 4, random), gloss);
  if (random.chance(0.5)) {
    const float width = 0.4f * cover.x();
    model.add(makeRectangle({width / 2, cover.y() / 2 + 4e-4f, 0.8f * cover.z()}, {-width, 0, 0}, {0, 0, -0.3f * width},
                            kObjectCell_m),
              paintDocument(0.1, 0.03, random), 0.02f);
  }
  model.transform(onItsBack(cover));
  return model;
}

ObjectModel makeOpenMagazine(RandomStream& random) {
  const float width = size(random, 0.18, 0.22), height = size(random, 0.25, 0.29);
  const double fold = random.between(0.08, 0.35), tilt = random.between(0.15, 0.5);
  ObjectModel model{"open magazine", {}};
  for (const double side : {-1.0, 1.0}) {
    Pose turn = Pose::Identity();
    turn.rotate(Eigen::AngleAxisd(side * fold, Vector3d::UnitZ()));
    turn.translate(Vector3d(side * static_cast<double>(width) / 2, 0, 0));
    const cv::Mat3b print = random.chance(0.5) ? paintDocument(0.2, 0.27, random) : paintCover(0.2, 0.27, random);
    addPrinted(model, {width, 0.004f, height}, print, 0.12f, turn, random);
  }
  lean(model, tilt);
  return model;
}

ObjectModel makeBrochure(RandomStream& random) {
  const float width = size(random, 0.1, 0.22);
  const Vector3f paper{width, size(random, 0.003, 0.015), size(random, 1.2, 1.6) * width};
  ObjectModel model{"brochure", {}};
  const cv::Mat3b print = random.chance(0.3) ? paintDocument(asDouble(paper).x(), asDouble(paper).z(), random)
                                             : paintCover(asDouble(paper).x(), asDouble(paper).z(), random);
  addPrinted(model, paper, print, 0.12f, Pose::Identity(), random);
  lean(model, random.between(0.1, 0.35));
  return model;
}

ObjectModel makePictureFrame(RandomStream& random) {
  const float width = size(random, 0.1, 0.2);
  const Vector3f frame{width, size(random, 0.015, 0.03), size(random, 0.7, 1.4) * width};
  ObjectModel model{"picture frame", {}};
  model.add(makeTiledBox(frame, 0.4f, kObjectCell_m),
            random.chance(0.5) ? paintWood({110, 160, 200}, random) : paintMottled(quietColor(random), 5, random),
            0.1f);
  const float rim = size(random, 0.08, 0.16) * width;
  const bool screen = random.chance(0.4);
  model.add(makeRectangle({width / 2 - rim, frame.y() / 2 + 6e-4f, frame.z() - rim}, {2 * rim - width, 0, 0},
                          {0, 0, 2 * rim - frame.z()}, kObjectCell_m),
            screen ? paintMottled({58, 55, 52}, 3, random) : paintCover(0.12, 0.15, random), screen ? 0.3f : 0.15f);
  lean(model, random.between(0.1, 0.3));
  return model;
}

ObjectModel makeBinder(RandomStream& random) {
  const Vector3f binder{size(random, 0.035, 0.08), size(random, 0.27, 0.29), size(random, 0.3, 0.32)};
  ObjectModel model{"binder", {}};
  model.add(makeTiledBox(binder, 0.3f, kObjectCell_m), paintMottled(anyColor(random), 5, random), 0.08f);
  model.add(makeRectangle({0.4f * binder.x(), binder.y() / 2 + 5e-4f, 0.85f * binder.z()}, {-0.8f * binder.x(), 0, 0},
                          {0, 0, -0.5f * binder.z()}, kObjectCell_m),
            paintDocument(0.05, 0.15, random), 0.02f);
  return model;
}

}  // namespace saccade
