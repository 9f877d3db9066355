#pragma once

#include <vector>

#include "rendering/pixel_canvas.hpp"
#include "rendering/ray_grid.hpp"
#include "saccade/map/map_cursor.hpp"
#include "saccade/rendering/ior_view.hpp"

namespace saccade {

/// Instructions that a walk may use. Both give the same bytes.
enum class InstructionSet { kPortable, kAvx2 };

/// The best set of the processor that runs this.
[[nodiscard]] InstructionSet bestInstructionSet();

/// Walks the octree front to back and puts the first occupied leaf of every ray on the canvas; appends each leaf that
/// some pixel sees to `leaves`. The canvas must be reset to the grid's size; kAvx2 only where the processor has it.
void walkOctree(const MapTree& map, const RayGrid& rays, InstructionSet instructions, PixelCanvas& canvas,
                std::vector<VisibleLeaf>& leaves);

}  // namespace saccade
