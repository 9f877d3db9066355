#include "saccade/exchange/map_points.hpp"

#include <bit>
#include <cstring>
#include <ostream>
#include <string>

// PCL's own writers want one compiled point type for each set of fields and take a minute to build; both formats are
// a text header and packed records.

namespace saccade {
namespace {

static_assert(std::endian::native == std::endian::little, "records are written as they lie in memory");

Eigen::Vector3f centreOf(const NodeKey& key, double leaf_size_m) {
  const double half_edge = 0.5 * static_cast<double>(1 << (MapTree::kDepth - key.depth));
  const auto along = [&](std::uint16_t lowest) {
    return static_cast<float>((lowest - MapTree::kCentreKey + half_edge) * leaf_size_m);
  };
  return {along(key.corner.x), along(key.corner.y), along(key.corner.z)};
}

/// Records collected in one buffer, so that the stream is asked once in a while and not for every number.
class RecordStream {
 public:
  explicit RecordStream(std::ostream& out) : out_(out) {}
  ~RecordStream() { flush(); }
  RecordStream(const RecordStream&) = delete;
  RecordStream& operator=(const RecordStream&) = delete;

  template <typename T>
  void put(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    buffer_.append(bytes, sizeof(T));
    if (buffer_.size() > std::size_t{1} << 16) flush();
  }
  void put(const Eigen::Vector3f& vector) {
    for (int i = 0; i < 3; ++i) put(vector[i]);
  }

 private:
  void flush() {
    out_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }
  std::ostream& out_;
  std::string buffer_;
};

}  // namespace

std::vector<MapPoint> occupiedPoints(const IorMap& map, LeafPaint paint,
                                     const std::function<bool(const MapLeaf&)>& wanted) {
  std::vector<MapPoint> points;
  const Tick now = map.now();
  const MapTree tree = map.view();
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (!leaf.occupied || (wanted && !wanted(leaf))) return;
    MapPoint point;
    point.p_W = centreOf(leaf.key, tree.leaf_size_m);
    point.normal = leaf.surface.normal();
    point.color = paintLeaf(leaf.ior, leaf.surface, now, paint);
    point.ior_weight = weight(leaf.ior, now);
    point.ior_flag = inhibited(leaf.ior, now);
    point.log_odds = leaf.log_odds;
    point.leaf_m = static_cast<float>(tree.nodeSize_m(leaf.key.depth));
    points.push_back(point);
  });
  return points;
}

void writePly(std::span<const MapPoint> points, std::ostream& out) {
  out << "ply\nformat binary_little_endian 1.0\n"
         "comment saccade: occupied leaves, world frame, metres; ior_weight in ticks\n"
         "element vertex "
      << points.size() << "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) out << "property float " << name << "\n";
  for (const char* name : {"red", "green", "blue"}) out << "property uchar " << name << "\n";
  out << "property uint ior_weight\nproperty uchar ior_flag\nproperty float log_odds\nproperty float leaf_m\n"
         "end_header\n";
  RecordStream records(out);
  for (const MapPoint& point : points) {
    records.put(point.p_W);
    records.put(point.normal);
    for (const std::uint8_t channel : point.color) records.put(channel);
    records.put(point.ior_weight);
    records.put(static_cast<std::uint8_t>(point.ior_flag));
    records.put(point.log_odds);
    records.put(point.leaf_m);
  }
}

void writePcd(std::span<const MapPoint> points, std::ostream& out) {
  out << "# .PCD v0.7 - Point Cloud Data file format\n"
         "VERSION 0.7\n"
         "FIELDS x y z normal_x normal_y normal_z rgb ior_weight ior_flag log_odds leaf_m\n"
         "SIZE 4 4 4 4 4 4 4 4 1 4 4\n"
         "TYPE F F F F F F F U U F F\n"
         "COUNT 1 1 1 1 1 1 1 1 1 1 1\n"
         "WIDTH "
      << points.size() << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << points.size() << "\nDATA binary\n";
  RecordStream records(out);
  for (const MapPoint& point : points) {
    records.put(point.p_W);
    records.put(point.normal);
    records.put(std::uint32_t{point.color[0]} << 16 | std::uint32_t{point.color[1]} << 8 | point.color[2]);
    records.put(point.ior_weight);
    records.put(static_cast<std::uint8_t>(point.ior_flag));
    records.put(point.log_odds);
    records.put(point.leaf_m);
  }
}

}  // namespace saccade
