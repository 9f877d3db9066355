#include <cmath>

#include "simulation/mesh_shapes.hpp"
#include "simulation/model_parts.hpp"
#include "simulation/object_models.hpp"
#include "simulation/print_paint.hpp"
#include "simulation/texture_paint.hpp"

namespace saccade {
namespace {

ObjectModel makePackage(const char* kind, const Eigen::Vector3f& size_m, RandomStream& random) {
  ObjectModel model{kind, {}};
  model.add(makeBox(size_m), paintPackage(static_cast<double>(size_m.x()), static_cast<double>(size_m.z()), random),
            0.06f);
  return model;
}

}  // namespace

ObjectModel makeCerealBox(RandomStream& random) {
  const float width = size(random, 0.15, 0.21), depth = size(random, 0.05, 0.08), height = size(random, 0.22, 0.31);
  return makePackage("cereal box", {width, depth, height}, random);
}

ObjectModel makeSmallBox(RandomStream& random) {
  const float width = size(random, 0.08, 0.16), depth = size(random, 0.05, 0.11), height = size(random, 0.05, 0.15);
  return makePackage("box", {width, depth, height}, random);
}

ObjectModel makeTissueBox(RandomStream& random) {
  const float width = size(random, 0.21, 0.25), depth = size(random, 0.11, 0.13), height = size(random, 0.07, 0.11);
  ObjectModel model{"tissue box", {}};
  model.add(makeBox({width, depth, height}), paintCloth(random));
  // A crumpled sheet sticks out.
  std::vector<Eigen::Vector2f> crumple;
  for (int i = 0; i < 9; ++i) {
    const double angle = 2 * 3.14159265 * i / 9, radius = random.between(0.012, 0.03);
    crumple.emplace_back(1.6f * static_cast<float>(radius * std::cos(angle)),
                         static_cast<float>(radius * std::sin(angle)));
  }
  Mesh sheet = makeExtrusion(crumple, 0.04f);
  sheet.transform(Pose(Eigen::Translation3d(0, 0, static_cast<double>(height))));
  model.add(std::move(sheet), paintMottled({232, 236, 236}, 8, random));
  return model;
}

ObjectModel makeMilkCarton(RandomStream& random) {
  const float width = size(random, 0.065, 0.09), body = size(random, 0.15, 0.2), gable = 0.035f;
  ObjectModel model{"carton", {}};
  const cv::Mat3b print = paintPackage(static_cast<double>(width), static_cast<double>(body), random);
  model.add(makeBox({width, width, body}), print, 0.08f);
  // The gable is a triangular prism that lies on the body.
  Mesh roof = makeExtrusion({{-width / 2, 0},
                             {width / 2, 0},
                             {0.004f, gable},
                             {0.004f, gable + 0.018f},
                             {-0.004f, gable + 0.018f},
                             {-0.004f, gable}},
                            width);
  Pose lie = Pose::Identity();
  lie.translation() = Eigen::Vector3d(0, static_cast<double>(width) / 2, static_cast<double>(body));
  lie.rotate(Eigen::AngleAxisd(3.14159265 / 2, Eigen::Vector3d::UnitX()));
  roof.transform(lie);
  model.add(std::move(roof), print, 0.08f);
  return model;
}

ObjectModel makeCoffeeBag(RandomStream& random) {
  const float width = size(random, 0.08, 0.12), depth = size(random, 0.05, 0.07), height = size(random, 0.14, 0.21);
  ObjectModel model{"bag", {}};
  // A box whose upper end is pinched together.
  Mesh bag = makeBox({width, depth, height}, 0.01f);
  for (std::size_t i = 0; i < bag.vertices.size(); ++i) {
    Eigen::Vector3f& p = bag.vertices[i];
    const float share = p.z() / height;
    p.y() *= share < 0.7f ? 1.0f : 1.0f - 0.85f * (share - 0.7f) / 0.3f;
    p.y() += 0.003f * std::sin(70 * p.x() + 45 * p.z());
  }
  model.add(std::move(bag), paintPackage(static_cast<double>(width), static_cast<double>(height), random), 0.25f);
  return model;
}

ObjectModel makeLyingBook(RandomStream& random) {
  const float width = size(random, 0.13, 0.21), length = size(random, 0.19, 0.28), thick = size(random, 0.015, 0.045);
  ObjectModel model{"book", {}};
  Mesh book = makeBox({width, thick, length});
  Pose lie = Pose::Identity();
  lie.translation() = Eigen::Vector3d(0, static_cast<double>(length) / 2, static_cast<double>(thick) / 2);
  lie.rotate(Eigen::AngleAxisd(3.14159265 / 2, Eigen::Vector3d::UnitX()));
  book.transform(lie);
  model.add(std::move(book), paintBook(static_cast<double>(width), static_cast<double>(length), random), 0.08f);
  return model;
}

ObjectModel makeStandingBook(RandomStream& random) {
  const float depth = size(random, 0.13, 0.17), height = size(random, 0.18, 0.25), thick = size(random, 0.02, 0.05);
  ObjectModel model{"book", {}};
  // The spine, a narrow side, faces the room.
  Mesh book = makeBox({depth, thick, height});
  Pose turn = Pose::Identity();
  turn.rotate(Eigen::AngleAxisd(3.14159265 / 2, Eigen::Vector3d::UnitZ()));
  book.transform(turn);
  model.add(std::move(book), paintBook(static_cast<double>(depth), static_cast<double>(height), random), 0.08f);
  return model;
}

}  // namespace saccade
