#pragma once

#include <vector>

#include "saccade/simulation/scene.hpp"
#include "simulation/clutter.hpp"
#include "simulation/random_hash.hpp"

namespace saccade {

/// Textures that a dwelling's furniture shares.
struct Decor {
  int wall, floor, ceiling, wood, board, stone, tiles, cloth, dark, steel;
  float stone_gloss = 0.15f;

  /// Of a dwelling: wooden floor, white fronts.
  static Decor paint(Scene& scene, RandomStream& random);
  /// Of a place of work: carpet, fronts of any colour, small tiles.
  static Decor paintForWork(Scene& scene, RandomStream& random);
};

/// An opening in a wall from the floor to the lintel, in metres along the wall.
struct Doorway {
  double from_m = 0.0, to_m = 0.0;
};

/// Builds rooms and furniture, all background, and tells the clutter what is in its way. Positions are those of the
/// middle of a piece's back edge on the floor; `yaw` turns its front from +y.
class Furnisher {
 public:
  using PaintDecor = Decor (*)(Scene&, RandomStream&);

  Furnisher(Scene& scene, RandomStream& random, Clutter& clutter, PaintDecor paint = Decor::paint)
      : scene_(scene), random_(random), clutter_(clutter), decor_(paint(scene, random)) {}

  [[nodiscard]] const Decor& decor() const { return decor_; }

  void addFloorAndCeiling(const Eigen::Vector2d& low, const Eigen::Vector2d& high);
  /// A wall from a to b, seen from its left side, with skirting board.
  void addWall(const Eigen::Vector2d& a, const Eigen::Vector2d& b, int texture,
               const std::vector<Doorway>& doorways = {});
  /// A framed picture on a wall at `yaw` (its front's direction), `middle_W` on the wall's surface.
  void addPoster(const Eigen::Vector3d& middle_W, double yaw, double width_m, double height_m);
  Support addTable(const Eigen::Vector2d& back_W, double yaw, double width_m, double depth_m, double height_m);
  /// Kitchen cupboards below a stone top, tiles above it.
  Support addCounter(const Eigen::Vector2d& back_W, double yaw, double width_m);
  Support addWallShelf(const Eigen::Vector3d& back_W, double yaw, double width_m, double depth_m, double headroom_m);
  /// An open case with its boards, from the lowest to the top.
  std::vector<Support> addBookcase(const Eigen::Vector2d& back_W, double yaw, double width_m, double height_m);
  Support addSideboard(const Eigen::Vector2d& back_W, double yaw, double width_m);
  void addWardrobe(const Eigen::Vector2d& back_W, double yaw, double width_m);
  /// Seat for two or three, or a bed if `deep`; the seat is a support.
  Support addSofa(const Eigen::Vector2d& back_W, double yaw, double width_m, bool deep);
  void addChair(const Eigen::Vector2d& back_W, double yaw);

  // Fittings: what belongs to a room and is no object, with many parts that look like ones.

  /// A wooden chair with a padded seat; slats or a panel make its back.
  void addPaddedChair(const Eigen::Vector2d& back_W, double yaw);
  /// A chair on a column with five feet.
  void addSwivelChair(const Eigen::Vector2d& back_W, double yaw);
  /// Sheets and leaflets without frames on a wall, side by side from `from_W` on along the wall.
  void addLeaflets(const Eigen::Vector3d& from_W, double yaw, double length_m, int count);
  /// A flat screen on a wall; it shows a picture or is dark.
  void addWallScreen(const Eigen::Vector3d& middle_W, double yaw, double width_m);
  void addSockets(const Eigen::Vector3d& middle_W, double yaw, int count);
  /// A cable from a to b on a wall at `yaw`, hanging through by `sag_m`.
  void addCable(const Eigen::Vector3d& a_W, const Eigen::Vector3d& b_W, double yaw, double sag_m);
  void addPillar(const Eigen::Vector2d& middle_W, double width_m);
  void addRadiator(const Eigen::Vector2d& back_W, double yaw, double width_m);
  /// A computer's case on the floor.
  void addComputer(const Eigen::Vector2d& back_W, double yaw);
  void addSink(const Eigen::Vector3d& middle_W, double yaw);
  void addWallCupboards(const Eigen::Vector2d& back_W, double yaw, double width_m, double z_low_m);
  /// A window with a sill, frame and perhaps a blind; bright.
  void addWindow(const Eigen::Vector3d& middle_W, double yaw, double width_m, double height_m);

 private:
  /// A box standing at `foot` (middle of its ground) in the frame of the piece.
  void addBox(const Pose& T_WF, const Eigen::Vector3d& foot_F, const Eigen::Vector3d& size_m, int texture,
              double cell_m = 0.05, float gloss = 0.0f);
  void blockBox(const Pose& T_WF, const Eigen::Vector3d& foot_F, const Eigen::Vector3d& size_m);

  Scene& scene_;
  RandomStream& random_;
  Clutter& clutter_;
  Decor decor_;
};

}  // namespace saccade
