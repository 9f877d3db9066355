// Included by octree_walk.cpp once per instruction set, in the namespace that has its Lanes. No includes here.

/// One walk over the octree. Positions are in leaves relative to the camera centre, see RayGrid.
class OctreeWalk {
 public:
  OctreeWalk(const MapTree& map, const RayGrid& rays, PixelCanvas& canvas, std::vector<VisibleLeaf>& leaves)
      : map_(map), rays_(rays), canvas_(canvas), leaves_(leaves) {
    for (std::size_t depth = 1; depth < octants_.size(); ++depth) prepareOctants(static_cast<int>(depth));
  }

  void run() { visit(map_.root, {0, 0, 0}, 0, map_.root.isLeaf()); }

 private:
  using Corner = std::array<int, 3>;

  /// The eight children at a depth: centres relative to their parent's, frame C, and half extents.
  struct Octants {
    std::array<std::array<float, 8>, 3> offset;
    float half_edge = 0.0f;
    float half_depth = 0.0f;  ///< along the optical axis
    float radius = 0.0f;
  };
  /// Where the eight children lie in the image.
  struct Footprints {
    std::array<std::int32_t, 8> first_u, first_v, last_u, last_v;
    unsigned visible = 0;  ///< bit i: child i is in range and its rectangle not empty; else its rectangle means nothing

    [[nodiscard]] PixelRect rect(unsigned i) const { return {first_u[i], first_v[i], last_u[i], last_v[i]}; }
  };
  void prepareOctants(int depth);
  void visit(MapNode node, const Corner& corner, int depth, bool coarse);
  [[nodiscard]] unsigned occupiedChildren(MapNode node) const;
  static void prefetchFamilies(MapNode node, unsigned children);
  [[nodiscard]] static unsigned frontToBack(unsigned octants, unsigned nearest);
  [[nodiscard]] Footprints footprints(const std::array<float, 3>& centre, int child_depth) const;
  [[nodiscard]] bool inPyramid(float x, float y, float z, float radius) const;
  [[nodiscard]] static Corner childCorner(const Corner& corner, unsigned octant, int half) {
    return {corner[0] + ((octant & 1u) != 0 ? half : 0), corner[1] + ((octant & 2u) != 0 ? half : 0),
            corner[2] + ((octant & 4u) != 0 ? half : 0)};
  }
  void draw(MapNode node, const Corner& corner, const PixelRect& rect);
  [[nodiscard]] bool drawWindow(const Corner& corner, std::int32_t leaf, int u, int v, std::uint64_t open);
  template <bool kAround>
  [[nodiscard]] std::uint64_t intersect(const std::array<float, 3>& entry_plane, const std::array<float, 3>& exit_plane,
                                        unsigned around, std::int32_t leaf, int u, int v, std::uint64_t open);

  const MapTree& map_;
  const RayGrid& rays_;
  PixelCanvas& canvas_;
  std::vector<VisibleLeaf>& leaves_;
  std::array<Octants, MapTree::kDepth + 1> octants_;
};

inline void OctreeWalk::prepareOctants(int depth) {
  Octants& octants = octants_[static_cast<std::size_t>(depth)];
  const float half = 0.5f * static_cast<float>(1 << (MapTree::kDepth - depth));
  octants.half_edge = half;
  octants.radius = half * 1.7321f;
  const auto& depth_row = rays_.R_CW[2];
  octants.half_depth = half * (std::fabs(depth_row[0]) + std::fabs(depth_row[1]) + std::fabs(depth_row[2]));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < 8; ++i) {
      float sum = 0.0f;
      for (std::size_t w = 0; w < 3; ++w) sum += rays_.R_CW[axis][w] * ((i >> w & 1u) != 0 ? half : -half);
      octants.offset[axis][i] = sum;
    }
  }
}

/// Draws what is visible of the children of an occupied node. `coarse`: the node is a leaf above the finest depth,
/// whose cells are all as the leaf itself.
inline void OctreeWalk::visit(MapNode node, const Corner& corner, int depth, bool coarse) {
  const int half = 1 << (MapTree::kDepth - 1 - depth);
  std::array<float, 3> centre;
  unsigned nearest = 0;  // the child on the camera's side of all three middle planes: none hides it
  for (std::size_t axis = 0; axis < 3; ++axis) {
    centre[axis] = static_cast<float>(corner[axis] + half - rays_.origin_key[axis]) - rays_.origin_fraction[axis];
    if (centre[axis] <= 0.0f) nearest |= 1u << axis;
  }
  const Footprints seen = footprints(centre, depth + 1);
  const unsigned chosen = seen.visible & (coarse ? 0xFFu : occupiedChildren(node));
  if (depth + 2 <= MapTree::kDepth && !coarse) prefetchFamilies(node, chosen);
  // In the order nearest ^ 0, nearest ^ 1, ... an octant comes after all that can hide it.
  unsigned places = frontToBack(chosen, nearest);
  if (half == 1) {
    for (; places != 0; places &= places - 1) {
      const unsigned octant = nearest ^ static_cast<unsigned>(std::countr_zero(places));
      draw(coarse ? node : node.child(octant), childCorner(corner, octant, 1), seen.rect(octant));
    }
    return;
  }
  for (; places != 0; places &= places - 1) {
    const unsigned octant = nearest ^ static_cast<unsigned>(std::countr_zero(places));
    if (!canvas_.isOpen(seen.rect(octant))) continue;
    const MapNode child = coarse ? node : node.child(octant);
    visit(child, childCorner(corner, octant, half), depth + 1, coarse || child.isLeaf());
  }
}

/// Bit i: child i exists and is occupied, or something below it is.
inline unsigned OctreeWalk::occupiedChildren(MapNode node) const {
  const unsigned existing = node.childMask();
  unsigned occupied = 0;
  for (unsigned i = 0; i < 8; ++i) {
    // The place of a child that does not exist is in the family's memory all the same; what is read there is ignored.
    occupied |= static_cast<unsigned>(node.child(i).logOdds() >= map_.occupied_log_odds) << i;
  }
  return existing & occupied;
}

/// Fetches the grandchildren into the cache while the first of them are being worked on.
inline void OctreeWalk::prefetchFamilies(MapNode node, unsigned children) {
  for (; children != 0; children &= children - 1) {
    const auto* family =
        static_cast<const std::byte*>(node.child(static_cast<unsigned>(std::countr_zero(children))).family());
    if (family == nullptr) continue;
    for (std::size_t line = NodeLayout::kFamilyNodes; line < NodeLayout::kFamilyBytes; line += 64) {
      __builtin_prefetch(family + line);
    }
  }
}

/// Moves bit i to place i ^ nearest.
inline unsigned OctreeWalk::frontToBack(unsigned octants, unsigned nearest) {
  const unsigned x = nearest & 1u, y = nearest & 2u, z = nearest & 4u;
  octants = x != 0 ? (octants & 0x55u) << 1 | (octants & 0xAAu) >> 1 : octants;
  octants = y != 0 ? (octants & 0x33u) << 2 | (octants & 0xCCu) >> 2 : octants;
  return z != 0 ? (octants & 0x0Fu) << 4 | (octants & 0xF0u) >> 4 : octants;
}

/// Rectangles that hold every pixel whose ray may meet a child. A corner of a cube around p, at p + d, has
/// u = fx (px + dx) / (pz + dz) + cx = fx px / pz + cx + fx (dx - (px / pz) dz) / (pz + dz), which is bounded by the
/// sum of the shares of the three edges over the least depth.
inline OctreeWalk::Footprints OctreeWalk::footprints(const std::array<float, 3>& centre, int child_depth) const {
  // Rounding must never cut off a ray that the exact test would let through; these margins are far above it.
  constexpr float kRangeMargin = 1e-3f, kPixelMargin = 0.02f, kRelativeMargin = 1e-5f;
  constexpr float kLeastDepth = 0.05f;  // of a node's half depth: nearer to the camera's plane the bound says nothing
  const Octants& octants = octants_[static_cast<std::size_t>(child_depth)];
  std::array<Lanes, 3> p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& row = rays_.R_CW[axis];
    p[axis] = Lanes::all(row[0] * centre[0] + row[1] * centre[1] + row[2] * centre[2]) +
              Lanes::load(octants.offset[axis].data());
  }
  const Lanes nearest = p[2] - Lanes::all(octants.half_depth);
  const Lanes farthest = p[2] + Lanes::all(octants.half_depth);
  Footprints result;
  const unsigned in_range = greater(farthest, Lanes::all(rays_.near * (1.0f - kRangeMargin))) &
                            greater(Lanes::all(rays_.far * (1.0f + kRangeMargin)), nearest);
  if (in_range == 0) return result;
  unsigned across = in_range & ~greater(nearest, Lanes::all(kLeastDepth * octants.half_depth));

  const Lanes zero = Lanes::all(0.0f);
  const Lanes share = Lanes::all(octants.half_edge) / nearest;
  const auto project = [&](std::size_t axis, float focal, float centre_pixel, int size, std::int32_t* first,
                           std::int32_t* last) {
    const Lanes slope = p[axis] / p[2];
    Lanes extent = zero;
    for (std::size_t w = 0; w < 3; ++w) {
      extent = extent + abs(Lanes::all(rays_.R_CW[axis][w]) - slope * Lanes::all(rays_.R_CW[2][w]));
    }
    const Lanes offset = slope * Lanes::all(focal);
    extent = extent * share * Lanes::all(focal);
    extent = extent + Lanes::all(kPixelMargin) + (extent + abs(offset)) * Lanes::all(kRelativeMargin);
    const Lanes middle = offset + Lanes::all(centre_pixel);
    const Lanes last_pixel = Lanes::all(static_cast<float>(size - 1));
    const Lanes low = middle - extent, high = middle + extent;
    // Rounds up, less a little that the margin allows for.
    const Lanes begin = truncated(min(max(low, zero) + Lanes::all(0.999f), last_pixel + Lanes::all(1.0f)));
    const Lanes end = truncated(max(min(high, last_pixel), zero));
    begin.storeWhole(first);
    end.storeWhole(last);
    return ~greater(begin, end) & greater(high, zero);
  };
  const unsigned in_image = project(0, rays_.fx, rays_.cx, rays_.width, result.first_u.data(), result.last_u.data()) &
                            project(1, rays_.fy, rays_.cy, rays_.height, result.first_v.data(), result.last_v.data());
  result.visible = in_range & ~across & in_image;

  for (unsigned i = 0; across != 0; ++i, across >>= 1) {
    if ((across & 1u) == 0) continue;
    std::array<float, 3> q;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& row = rays_.R_CW[axis];
      q[axis] = row[0] * centre[0] + row[1] * centre[1] + row[2] * centre[2] + octants.offset[axis][i];
    }
    if (!inPyramid(q[0], q[1], q[2], octants.radius)) continue;
    result.visible |= 1u << i;
    result.first_u[i] = result.first_v[i] = 0;
    result.last_u[i] = rays_.width - 1;
    result.last_v[i] = rays_.height - 1;
  }
  return result;
}

/// Whether a ball at (x, y, z) in frame C may meet the viewing pyramid.
inline bool OctreeWalk::inPyramid(float x, float y, float z, float radius) const {
  constexpr float kMargin = 1.001f;
  for (const auto& n : rays_.sides) {
    if (n[0] * x + n[1] * y + n[2] * z < -kMargin * radius - 0.01f) return false;
  }
  return true;
}

/// Gives the open pixels of `rect` whose rays meet the leaf to it. Most leaves that come here have none: they are
/// hidden by those before them.
__attribute__((always_inline)) inline void OctreeWalk::draw(MapNode node, const Corner& corner, const PixelRect& rect) {
  const auto leaf = static_cast<std::int32_t>(leaves_.size());
  bool any = false;
  for (int v = rect.first_v; v <= rect.last_v; v += 8) {
    for (int u = rect.first_u; u <= rect.last_u; u += 8) {
      const std::uint64_t open = canvas_.openInWindow(u, v) & PixelCanvas::windowBits(rect, u, v);
      if (open != 0) any |= drawWindow(corner, leaf, u, v, open);
    }
  }
  if (!any) return;
  const LeafKey key{static_cast<std::uint16_t>(corner[0]), static_cast<std::uint16_t>(corner[1]),
                    static_cast<std::uint16_t>(corner[2])};
  leaves_.push_back({key, node.ior(), node.surface()});
}

/// Gives the `open` pixels of a window whose rays meet the leaf at `corner` to it; returns whether there are any.
inline bool OctreeWalk::drawWindow(const Corner& corner, std::int32_t leaf, int u, int v, std::uint64_t open) {
  std::array<float, 3> entry, exit;
  unsigned around = 0;  // axes along which the camera lies between the leaf's planes: no entry, either may be the exit
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<float>& table = rays_.inverse_distance[axis];
    const auto position = static_cast<std::size_t>(corner[axis] - rays_.first_plane[axis]);
    if (position + 1 >= table.size()) return false;  // out of the reach of all rays
    const float low = table[position], high = table[position + 1];
    const bool beyond = high < 0.0f;  // the camera, as seen along the axis
    entry[axis] = beyond ? high : low;
    exit[axis] = beyond ? low : high;
    around |= static_cast<unsigned>(!beyond && low < 0.0f) << axis;
  }
  const std::uint64_t met = around == 0 ? intersect<false>(entry, exit, 0, leaf, u, v, open)
                                        : intersect<true>(entry, exit, around, leaf, u, v, open);
  canvas_.closeInWindow(u, v, met);
  return met != 0;
}

/// The exact test, row by row, of the `open` pixels of a window: a ray is in the leaf where it has passed the three
/// entry planes and none of the exit planes, so it meets it if the least inverse depth of an entry is above the largest
/// of an exit. Touching an edge is not meeting. Writes the pixels that meet it and returns them.
template <bool kAround>
inline std::uint64_t OctreeWalk::intersect(const std::array<float, 3>& entry_plane,
                                           const std::array<float, 3>& exit_plane, unsigned around, std::int32_t leaf,
                                           int u, int v, std::uint64_t open) {
  std::array<Lanes, 3> column, entry, exit;
  std::array<const float*, 3> row;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    column[axis] = Lanes::load(&rays_.column[axis][static_cast<std::size_t>(u)]);
    row[axis] = &rays_.row[axis][static_cast<std::size_t>(v)];
    entry[axis] = Lanes::all(entry_plane[axis]);
    exit[axis] = Lanes::all(exit_plane[axis]);
  }
  const Lanes inverse_near = Lanes::all(rays_.inverse_near);
  const Lanes inverse_far = Lanes::all(rays_.inverse_far);
  const int first_row = std::countr_zero(open) >> 3, last_row = 7 - (std::countl_zero(open) >> 3);
  const std::ptrdiff_t stride = canvas_.stride();
  float* depth_row = canvas_.inverseDepth(u, v + first_row);
  std::int32_t* leaf_row = canvas_.leaf(u, v + first_row);
  std::uint64_t all_met = 0;
  for (int y = first_row; y <= last_row; ++y, depth_row += stride, leaf_row += stride) {
    Lanes in = inverse_near, out = inverse_far;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Lanes direction = column[axis] + Lanes::all(row[axis][y]);
      const Lanes enters = direction * entry[axis], leaves = direction * exit[axis];
      if (kAround && (around >> axis & 1u) != 0) {
        out = max(out, max(enters, leaves));
      } else {
        in = min(in, enters);
        out = max(out, leaves);
      }
    }
    const unsigned met = greater(in, out) & static_cast<unsigned>(open >> 8 * y & 0xFFu);
    in.storeWhere(met, depth_row, leaf, leaf_row);
    all_met |= static_cast<std::uint64_t>(met) << 8 * y;
  }
  return all_met;
}
