#include "simulation/object_models.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "simulation/mesh_shapes.hpp"

namespace saccade {
namespace {

struct Maker {
  const char* name;
  ObjectMaker make;
  float thinnest_m = 0.01f;
};

const Maker kMakers[] = {{"cereal", makeCerealBox},
                         {"small box", makeSmallBox},
                         {"tissues", makeTissueBox},
                         {"carton", makeMilkCarton},
                         {"bag", makeCoffeeBag},
                         {"lying book", makeLyingBook},
                         {"standing book", makeStandingBook},
                         {"mug", makeMug},
                         {"bowl", makeBowl},
                         {"plate", makePlate},
                         {"bottle", makeBottle},
                         {"spray", makeSprayBottle},
                         {"can", makeCan},
                         {"jar", makeJar},
                         {"teapot", makeTeapot},
                         {"vase", makeVase},
                         {"coffee machine", makeCoffeeMachine},
                         {"toaster", makeToaster},
                         {"apple", makeApple},
                         {"citrus", makeCitrus},
                         {"pear", makePear},
                         {"banana", makeBanana},
                         {"plant", makePlant},
                         {"hammer", makeHammer},
                         {"screwdriver", makeScrewdriver},
                         {"tape", makeTapeRoll},
                         {"car", makeToyCar},
                         {"bear", makeToyBear},
                         {"duck", makeDuck},
                         {"bricks", makeBricks},
                         {"ball", makeBall},
                         {"telephone", makeTelephone},
                         {"laptop", makeLaptop},
                         {"keyboard", makeKeyboard},
                         {"clock", makeClock},
                         {"basket", makeBasket},
                         {"sheet", makeSheet, 1e-3f},
                         {"magazine", makeMagazine, 3e-3f},
                         {"folder", makeFolder, 4e-3f},
                         {"open magazine", makeOpenMagazine},
                         {"brochure", makeBrochure},
                         {"picture frame", makePictureFrame},
                         {"binder", makeBinder},
                         {"mouse", makeMouse},
                         {"gamepad", makeGamepad},
                         {"remote", makeRemote},
                         {"pen", makePen, 7e-3f},
                         {"pen pot", makePenPot},
                         {"stapler", makeStapler},
                         {"paper cup", makePaperCup},
                         {"storage box", makeStorageBox},
                         {"parcel", makeParcel},
                         {"plinth", makePlinth}};

TEST(ObjectModels, RestOnTheirSupportAndHaveEverydaySizes) {
  // Fur, peel and bent paper apart, the lowest point touches.
  constexpr float kTouch_m = 1e-3f;
  for (const auto& [name, make, thinnest_m] : kMakers) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
      RandomStream random(seed);
      const ObjectModel model = make(random);
      Eigen::AlignedBox3f box;
      for (const ObjectModel::Part& part : model.parts) {
        for (const Eigen::Vector3f& p : part.mesh.vertices) box.extend(p);
      }
      EXPECT_NEAR(box.min().z(), 0.0f, kTouch_m) << name << ", seed " << seed;
      EXPECT_GT(box.sizes().minCoeff(), thinnest_m) << name;
      EXPECT_LT(box.sizes().maxCoeff(), 0.5f) << name;
      const Eigen::Vector3f middle = box.center();
      EXPECT_LT(middle.head<2>().norm(), 0.2f) << name << " stands near the axis";
    }
  }
}

TEST(ObjectModels, TurnTheirFacesTheWayTheirNormalsPoint) {
  for (const auto& [name, make, thinnest_m] : kMakers) {
    RandomStream random(3);
    for (const ObjectModel::Part& part : make(random).parts) {
      const Mesh& mesh = part.mesh;
      int wrong = 0;
      for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3f cross = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
        const Eigen::Vector3f normal = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
        wrong += cross.norm() > 1e-9f && cross.dot(normal) < 0 ? 1 : 0;
      }
      // Caps of bent tubes and leaves may fold over at a few places.
      EXPECT_LE(wrong, static_cast<int>(mesh.triangles.size()) / 10) << name;
    }
  }
}

TEST(ObjectModels, AreTheSameForTheSameSeed) {
  for (const auto& [name, make, thinnest_m] : kMakers) {
    RandomStream first(9), second(9);
    const ObjectModel a = make(first), b = make(second);
    ASSERT_EQ(a.parts.size(), b.parts.size()) << name;
    for (std::size_t i = 0; i < a.parts.size(); ++i) {
      EXPECT_EQ(a.parts[i].mesh.vertices, b.parts[i].mesh.vertices) << name;
      EXPECT_EQ(cv::norm(a.parts[i].texture, b.parts[i].texture, cv::NORM_INF), 0.0) << name;
    }
  }
}

TEST(MeshShapes, KeepVerticesCloseEnoughToHoldLight) {
  const Mesh board = makeRectangle({0, 0, 0}, {1.0f, 0, 0}, {0, -0.5f, 0}, 0.1f);
  EXPECT_EQ(board.vertices.size(), 11u * 6u);
  EXPECT_EQ(board.triangles.size(), 2u * 10u * 5u);
  EXPECT_TRUE(board.normals[0].isApprox(Eigen::Vector3f(0, 0, 1)));
}

}  // namespace
}  // namespace saccade
