#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/simulation/mesh.hpp"
#include "simulation/random_hash.hpp"

namespace saccade {

/// A thing of everyday life in the pose in which it rests: standing on z = 0 near the z axis, front towards +y.
struct ObjectModel {
  struct Part {
    Mesh mesh;
    cv::Mat3b texture;
    float gloss = 0.0f;
  };
  std::string kind;
  std::vector<Part> parts;

  void add(Mesh mesh, const cv::Mat3b& texture, float gloss = 0.0f) {
    parts.push_back({std::move(mesh), texture, gloss});
  }
  void transform(const Pose& motion) {
    for (Part& part : parts) part.mesh.transform(motion);
  }
};

using ObjectMaker = ObjectModel (*)(RandomStream&);

// Packages and books.
ObjectModel makeCerealBox(RandomStream& random);
ObjectModel makeSmallBox(RandomStream& random);
ObjectModel makeTissueBox(RandomStream& random);
ObjectModel makeMilkCarton(RandomStream& random);
ObjectModel makeCoffeeBag(RandomStream& random);
ObjectModel makeLyingBook(RandomStream& random);
ObjectModel makeStandingBook(RandomStream& random);

// Paper. Sheets, magazines and folders lie; the others stand or lean back.
ObjectModel makeSheet(RandomStream& random);
ObjectModel makeMagazine(RandomStream& random);
ObjectModel makeFolder(RandomStream& random);
ObjectModel makeOpenMagazine(RandomStream& random);
ObjectModel makeBrochure(RandomStream& random);
ObjectModel makePictureFrame(RandomStream& random);
ObjectModel makeBinder(RandomStream& random);

// What lies about in offices.
ObjectModel makeMouse(RandomStream& random);
ObjectModel makeGamepad(RandomStream& random);
ObjectModel makeRemote(RandomStream& random);
ObjectModel makePen(RandomStream& random);
ObjectModel makePenPot(RandomStream& random);
ObjectModel makeStapler(RandomStream& random);
ObjectModel makePaperCup(RandomStream& random);
ObjectModel makeStorageBox(RandomStream& random);
ObjectModel makeParcel(RandomStream& random);
/// A low, even box on which other things may stand.
ObjectModel makePlinth(RandomStream& random);

// Ware and what kitchens hold.
ObjectModel makeMug(RandomStream& random);
ObjectModel makeBowl(RandomStream& random);
ObjectModel makePlate(RandomStream& random);
ObjectModel makeBottle(RandomStream& random);
ObjectModel makeSprayBottle(RandomStream& random);
ObjectModel makeCan(RandomStream& random);
ObjectModel makeJar(RandomStream& random);
ObjectModel makeTeapot(RandomStream& random);
ObjectModel makeVase(RandomStream& random);
ObjectModel makeCoffeeMachine(RandomStream& random);
ObjectModel makeToaster(RandomStream& random);

// Grown things.
ObjectModel makeApple(RandomStream& random);
ObjectModel makeCitrus(RandomStream& random);
ObjectModel makePear(RandomStream& random);
ObjectModel makeBanana(RandomStream& random);
ObjectModel makePlant(RandomStream& random);

// Tools, toys and devices.
ObjectModel makeHammer(RandomStream& random);
ObjectModel makeScrewdriver(RandomStream& random);
ObjectModel makeTapeRoll(RandomStream& random);
ObjectModel makeToyCar(RandomStream& random);
ObjectModel makeToyBear(RandomStream& random);
ObjectModel makeDuck(RandomStream& random);
ObjectModel makeBricks(RandomStream& random);
ObjectModel makeBall(RandomStream& random);
ObjectModel makeTelephone(RandomStream& random);
ObjectModel makeLaptop(RandomStream& random);
ObjectModel makeKeyboard(RandomStream& random);
ObjectModel makeClock(RandomStream& random);
ObjectModel makeBasket(RandomStream& random);

}  // namespace saccade
