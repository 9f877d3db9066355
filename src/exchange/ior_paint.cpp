#include "saccade/exchange/ior_paint.hpp"

namespace saccade {
namespace {

/// IOR weight at which a colour is half way up its scale: what the flag first gives with the default settings.
constexpr double kHalfWay = 18.0;

std::uint8_t mixed(double from, double to, double share) {
  return static_cast<std::uint8_t>(from + (to - from) * share + 0.5);
}

}  // namespace

Rgb paintLeaf(IorState ior, const LeafSurface& surface, Tick now, LeafPaint paint) {
  const bool has_color = surface.observations > 0;
  if (paint == LeafPaint::kColor) {
    return has_color ? Rgb{surface.red, surface.green, surface.blue} : Rgb{255, 255, 255};
  }
  const double w = weight(ior, now);
  const double share = w / (w + kHalfWay);
  if (inhibited(ior, now)) return {255, mixed(40, 255, share), mixed(0, 60, share)};
  const double luminance =
      has_color ? 0.299 * surface.red + 0.587 * surface.green + 0.114 * surface.blue : 128.0;  // ITU-R BT.601
  const double grey = 30.0 + 0.4 * luminance;
  if (w == 0.0) return {mixed(grey, 0, 0), mixed(grey, 0, 0), mixed(grey, 0, 0)};
  return {mixed(grey, 30, share), mixed(grey, 110, share), mixed(140, 255, share)};
}

}  // namespace saccade
