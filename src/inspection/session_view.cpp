#include "saccade/inspection/session_view.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <thread>
#include <tuple>

#include <fmt/format.h>

#include "inspection/attention_memory.hpp"
#include "inspection/byte_cache.hpp"
#include "inspection/session_pictures.hpp"
#include "inspection/tile_entries.hpp"
#include "inspection/view_json.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/exchange/map_difference.hpp"
#include "saccade/inspection/voxel_tile.hpp"
#include "saccade/map/morton_code.hpp"

namespace saccade {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kKeptVoxelBytes = 64u << 20;
constexpr int kLookInterval_ms = 250;  ///< between two looks whether the session has changed
enum Change : std::uint32_t { kAppeared = 1, kGone = 2, kGainedAttention = 3 };

/// Attention closes the tick that a frame's row names; what it met and did belongs to the one before.
Tick attendedTick(const FrameRecord& frame) {
  return Tick{frame.tick > 0 ? frame.tick - 1 : 0};
}

ordered_json boxJson(const Eigen::AlignedBox3d& box) {
  return {box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()};
}

/// The frame whose attention closed a tick; none if no frame did.
const FrameRecord* frameOf(const std::vector<FrameRecord>& frames, Tick tick) {
  const auto found = std::find_if(frames.begin(), frames.end(), [&](const FrameRecord& frame) {
    return frame.T_WC && frame.tick > 0 && attendedTick(frame) == tick;
  });
  return found == frames.end() ? nullptr : &*found;
}

}  // namespace

/// The session is open twice, so that pictures, which take long, keep nobody from tiles. Whoever takes more than one
/// mutex takes them in the order in which they stand here.
struct SessionView::Parts {
  std::filesystem::path path;
  std::optional<std::filesystem::path> before;

  std::mutex attention_mutex;
  std::optional<AttentionMemory> attention;

  std::mutex picture_mutex;
  std::optional<OpenSession> picture_session;
  std::optional<SessionPictures> pictures;
  std::optional<std::string> last_seen;

  std::mutex mutex;
  std::optional<OpenSession> session;
  ByteCache<std::pair<NodeKey, int>> voxel_cache{kKeptVoxelBytes};
  std::optional<std::string> difference;
  std::uint64_t version = 1;

  OpenSession& openSession();
  AttentionMemory& openAttention();
  SessionPictures& openPictures();
  void close();
  std::optional<std::string> pictureAt(std::int64_t ordinal, ViewPicture layer, SessionPictures& shown);
};

/// For those who hold `mutex`.
OpenSession& SessionView::Parts::openSession() {
  if (!session) session.emplace(path);
  return *session;
}

/// For those who hold `attention_mutex`, and not yet `mutex`.
AttentionMemory& SessionView::Parts::openAttention() {
  if (!attention) {
    const std::lock_guard lock(mutex);
    attention.emplace(openSession());
  }
  return *attention;
}

/// For those who hold `picture_mutex`.
SessionPictures& SessionView::Parts::openPictures() {
  if (!pictures) pictures.emplace(picture_session.emplace(path));
  return *pictures;
}

/// For those who hold all of the mutexes.
void SessionView::Parts::close() {
  attention.reset();
  pictures.reset();
  picture_session.reset();
  last_seen.reset();
  session.reset();
  voxel_cache.clear();
  difference.reset();
}

SessionView::SessionView(const std::filesystem::path& path, const std::optional<std::filesystem::path>& before)
    : parts_(std::make_unique<Parts>()) {
  parts_->path = path;
  parts_->before = before;
  const double leaf_size_m = parts_->openSession().reader.metadata().leaf_size_m;
  if (!before) return;
  const double before_m = SessionReader(*before).metadata().leaf_size_m;
  if (before_m != leaf_size_m) {
    throw IoError(*before, fmt::format("leaves of {} m as in {}", leaf_size_m, path.string()),
                  fmt::format("leaves of {} m", before_m));
  }
}

SessionView::~SessionView() = default;

std::string SessionView::summary() {
  const std::lock_guard lock(parts_->mutex);
  const OpenSession& session = parts_->openSession();
  const SessionMetadata& meta = session.reader.metadata();
  return ordered_json{{"title", parts_->path.filename().string()},
                      {"before", parts_->before ? ordered_json(parts_->before->filename().string()) : nullptr},
                      {"input", meta.input},
                      {"input_kind", meta.input_kind},
                      {"created_utc", meta.created_utc},
                      {"saccade_version", meta.saccade_version},
                      {"state", nameOf(meta.state)},
                      {"camera", cameraJson(meta.camera)},
                      {"leaf_size_m", meta.leaf_size_m},
                      {"leaves", meta.leaves},
                      {"tick", meta.tick},
                      {"frames", session.frames.size()},
                      {"keyframes", session.keyframe_ordinals},
                      {"ior_limit", session.config.map.ior.ior_limit},
                      {"mf", session.config.map.ior.mf},
                      {"config", meta.config_yaml}}
      .dump();
}

std::string SessionView::frames() {
  const std::lock_guard lock(parts_->mutex);
  const OpenSession& session = parts_->openSession();
  return framesJson(session.frames, session.revisitRates()).dump();
}

std::string SessionView::candidates(std::int64_t ordinal) {
  const std::lock_guard attention_lock(parts_->attention_mutex);
  const AttentionMemory& attention = parts_->openAttention();
  const std::lock_guard lock(parts_->mutex);
  const OpenSession& session = parts_->openSession();
  const SessionMetadata& meta = session.reader.metadata();
  const auto frame = session.reader.frame(FrameOrdinal{ordinal});
  ordered_json json = ordered_json::array();
  if (!frame || !frame->T_WC) return json.dump();
  for (const CandidateRecord& candidate : session.reader.candidates(FrameOrdinal{ordinal})) {
    const cv::Rect seen =
        seenBox(attention.leavesOf(attendedTick(*frame), candidate.rank), meta.leaf_size_m, meta.camera, *frame->T_WC);
    const cv::Rect& box = seen.area() > 0 ? seen : candidate.box;
    const bool has_depth = candidate.box3d_m != std::array<double, 6>{};
    json.push_back({{"rank", candidate.rank},
                    {"score", candidate.score},
                    {"source", candidate.source},
                    {"box", {box.x, box.y, box.width, box.height}},
                    {"box3d", has_depth ? ordered_json(candidate.box3d_m) : ordered_json(nullptr)},
                    {"revisited", candidate.revisited_share}});
  }
  return json.dump();
}

std::string SessionView::objects(Tick tick) {
  const std::lock_guard lock(parts_->attention_mutex);
  AttentionMemory& attention = parts_->openAttention();
  ordered_json json = ordered_json::array();
  for (const RememberedObject& remembered : attention.objects()) {
    const ObjectInhibition now = attention.inhibitionOf(remembered.object, tick);
    ordered_json looks = ordered_json::array();
    for (const ObjectLook& look : remembered.object.looks) looks.push_back({look.tick.value, look.rank});
    json.push_back({{"id", remembered.object.id.value},
                    {"box3d", boxJson(remembered.box_W)},
                    {"leaves", 8 * remembered.object.blocks.size()},
                    {"looks", std::move(looks)},
                    {"flags", remembered.flags},
                    {"inhibited", now.inhibited},
                    {"first_expiry", now.first_expiry},
                    {"last_expiry", now.last_expiry}});
  }
  return json.dump();
}

std::string SessionView::tileList() {
  const std::lock_guard lock(parts_->mutex);
  const OpenSession& session = parts_->openSession();
  const std::vector<std::uint32_t> checksums = session.tileChecksums();
  ordered_json json = ordered_json::array();
  for (std::size_t i = 0; i < std::min(session.roots.size(), checksums.size()); ++i) {
    const NodeKey& root = session.roots[i];
    json.push_back({root.corner.x, root.corner.y, root.corner.z, root.depth, checksums[i]});
  }
  return json.dump();
}

std::vector<NodeKey> SessionView::tiles() {
  const std::lock_guard lock(parts_->mutex);
  return parts_->openSession().roots;
}

std::shared_ptr<const std::string> SessionView::voxels(const NodeKey& root, int voxel_depth) {
  const std::lock_guard lock(parts_->mutex);
  const std::pair<NodeKey, int> key(root, voxel_depth);
  if (auto kept = parts_->voxel_cache.find(key)) return kept;
  const IorMap tile = parts_->openSession().loadTile(root);
  auto bytes = std::make_shared<const std::string>(encodeVoxels(tile.view(), root, voxel_depth));
  parts_->voxel_cache.insert(key, bytes);
  return bytes;
}

std::string SessionView::attention(Tick tick) {
  const std::lock_guard lock(parts_->attention_mutex);
  return parts_->openAttention().replay().encode(tick);
}

std::string SessionView::lastSeen() {
  const std::lock_guard lock(parts_->picture_mutex);
  if (!parts_->last_seen) parts_->last_seen = parts_->openPictures().lastSeen();
  return *parts_->last_seen;
}

std::string SessionView::difference() {
  const std::lock_guard lock(parts_->mutex);
  if (!parts_->before) return {};
  if (parts_->difference) return *parts_->difference;
  const IorMap before = loadMap(SessionReader(*parts_->before));
  const MapDifference difference = compareMaps(before, loadMap(parts_->openSession().reader));
  std::vector<std::pair<std::uint64_t, Change>> changes;
  const auto note = [&](std::span<const LeafKey> leaves, Change change) {
    for (const LeafKey& key : leaves) changes.emplace_back(mortonCode(key), change);
  };
  for (const ChangedRegion& region : difference.appeared) note(region.leaves, kAppeared);
  for (const ChangedRegion& region : difference.gone) note(region.leaves, kGone);
  note(difference.attention_gained, kGainedAttention);
  std::sort(changes.begin(), changes.end());  // of a leaf that appeared and gained attention, "appeared" comes first
  TileEntries entries;
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (i == 0 || changes[i].first != changes[i - 1].first) entries.add(changes[i].first, changes[i].second);
  }
  return parts_->difference.emplace(entries.take());
}

std::string SessionView::leaf(LeafKey key) {
  std::vector<AttendedBy> attentions;
  {
    const std::lock_guard lock(parts_->attention_mutex);
    const AttentionMemory& attention = parts_->openAttention();
    const std::lock_guard session_lock(parts_->mutex);
    attentions = attentionsOf(attention.log(), key, parts_->openSession().config.map.attend_blocks);
  }
  const std::lock_guard lock(parts_->mutex);
  const OpenSession& session = parts_->openSession();
  for (const NodeKey& root : session.roots) {
    const int bits = MapTree::kDepth - root.depth;
    const auto cell = [&](LeafKey k) { return std::tuple(k.x >> bits, k.y >> bits, k.z >> bits); };
    if (cell(key) != cell(root.corner)) continue;
    const IorMap tile = session.loadTile(root);
    if (const auto leaf = tile.findLeaf(key)) {
      return leafJson(*leaf, key, session.reader.metadata().leaf_size_m, tile.now(), attentions).dump();
    }
  }
  return "null";
}

std::optional<std::string> SessionView::Parts::pictureAt(std::int64_t ordinal, ViewPicture layer,
                                                         SessionPictures& shown) {
  const auto frame = picture_session->reader.frame(FrameOrdinal{ordinal});
  if (!frame) return std::nullopt;
  if (layer == ViewPicture::kColor || layer == ViewPicture::kSaliency) {
    const cv::Mat3b color = shown.color(ordinal);
    if (color.empty()) return std::nullopt;
    return jpegOf(layer == ViewPicture::kColor ? color : shown.saliency(color));
  }
  if (!frame->T_WC) return std::nullopt;
  if (layer == ViewPicture::kMap) return jpegOf(shown.map(*frame->T_WC));
  const Tick tick = attendedTick(*frame);
  return jpegOf(shown.ior(*frame->T_WC, tick, [&](LeafKey key) { return attention->replay().stateAt(key, tick); }));
}

std::optional<std::string> SessionView::picture(std::int64_t ordinal, ViewPicture layer) {
  std::unique_lock<std::mutex> attention_lock;
  if (layer == ViewPicture::kIor) {
    attention_lock = std::unique_lock(parts_->attention_mutex);
    (void)parts_->openAttention();
  }
  const std::lock_guard lock(parts_->picture_mutex);
  return parts_->pictureAt(ordinal, layer, parts_->openPictures());
}

std::optional<std::string> SessionView::crop(int id) {
  const std::lock_guard attention_lock(parts_->attention_mutex);
  const auto& objects = parts_->openAttention().objects();
  const auto found =
      std::find_if(objects.begin(), objects.end(), [&](const auto& o) { return o.object.id.value == id; });
  if (found == objects.end()) return std::nullopt;
  const std::lock_guard lock(parts_->picture_mutex);
  SessionPictures& pictures = parts_->openPictures();
  const OpenSession& session = *parts_->picture_session;

  std::vector<ObjectLook> looks = found->object.looks;
  std::stable_sort(looks.begin(), looks.end(), [](const auto& a, const auto& b) { return a.blocks > b.blocks; });
  for (const ObjectLook& look : looks) {
    const FrameRecord* frame = frameOf(session.frames, look.tick);
    if (frame == nullptr ||
        !std::binary_search(session.keyframe_ordinals.begin(), session.keyframe_ordinals.end(), frame->ordinal.value)) {
      continue;
    }
    const cv::Mat3b part = pictures.cut(pictures.color(frame->ordinal.value), *frame->T_WC, found->box_W);
    if (!part.empty()) return jpegOf(part);
  }
  const FrameRecord* best = frameOf(session.frames, found->object.bestView().tick);
  if (best == nullptr) return std::nullopt;
  const cv::Mat3b part = pictures.cut(pictures.map(*best->T_WC), *best->T_WC, found->box_W);
  return part.empty() ? std::nullopt : std::optional(jpegOf(part));
}

std::uint64_t SessionView::waitForChange(std::uint64_t version, int timeout_ms) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
  for (;;) {
    {
      const std::scoped_lock lock(parts_->attention_mutex, parts_->picture_mutex, parts_->mutex);
      if (parts_->openSession().changed()) {
        parts_->close();
        ++parts_->version;
      }
      if (parts_->version != version) return parts_->version;
    }
    if (std::chrono::steady_clock::now() >= end) return version;
    std::this_thread::sleep_for(std::chrono::milliseconds(kLookInterval_ms));
  }
}

std::unique_ptr<SessionView::Pause> SessionView::pause() {
  return std::make_unique<Pause>(*this);
}

SessionView::Pause::Pause(SessionView& view) : parts_(*view.parts_) {
  std::lock(parts_.attention_mutex, parts_.picture_mutex, parts_.mutex);
  parts_.close();
  ++parts_.version;
}

SessionView::Pause::~Pause() {
  parts_.mutex.unlock();
  parts_.picture_mutex.unlock();
  parts_.attention_mutex.unlock();
}

}  // namespace saccade
