#include "segmentation/open_edges.hpp"

#include <algorithm>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kBlock = 32;
static_assert(kBlock + 2 <= ColorEdges::kPadding);

/// All ones where the components of two rows of pixels differ, for whole vector blocks.
SACCADE_MULTIVERSION void markDifferent(const std::int32_t* here, const std::int32_t* there, int columns,
                                        std::uint16_t* open) {
  for (int x = 0; x < columns; x += kBlock) {
    for (int i = 0; i < kBlock; ++i) {
      open[x + i] = here[x + i] != there[x + i] ? std::uint16_t{0xFFFF} : std::uint16_t{0};
    }
  }
}

/// Edges of blocks of 2 x 2 pixels, p and q above r and s: p-q, p-r, p-s, q-r and r-s; q-s is p-r of the next block.
struct BlockSteps {
  const std::uint16_t *pq, *pr, *ps, *qr, *rs;
};
struct BlockMasks {
  std::uint16_t *pq, *pr, *ps, *qr, *rs;
};

BlockMasks masksOf(std::array<std::vector<std::uint16_t>, kEdgeDirections>& rows,
                   std::vector<std::uint16_t>& next_right) {
  return {rows[0].data(), rows[1].data(), rows[2].data(), rows[3].data() + 1, next_right.data()};
}

/// Closes the later one of two open edges of a triangle whose third one is not open, for whole vector blocks.
SACCADE_MULTIVERSION void closeLater(const BlockSteps& steps, const BlockMasks& different, const BlockMasks& open,
                                     int columns) {
  constexpr int kN = kBlock;
  for (int x = 0; x < columns; x += kN) {
    std::uint16_t a[kN], b[kN], c[kN], d[kN], e[kN], f[kN];  // in the order of edges of equal step, but for b and c
    std::uint16_t oa[kN], ob[kN], oc[kN], od[kN], oe[kN], of[kN];
    for (int i = 0; i < kN; ++i) {
      a[i] = steps.pq[x + i] & ColorEdges::kStepMask;
      b[i] = steps.pr[x + i] & ColorEdges::kStepMask;
      c[i] = steps.pr[x + i + 1] & ColorEdges::kStepMask;
      d[i] = steps.ps[x + i] & ColorEdges::kStepMask;
      e[i] = steps.qr[x + i] & ColorEdges::kStepMask;
      f[i] = steps.rs[x + i] & ColorEdges::kStepMask;
      oa[i] = different.pq[x + i];
      ob[i] = different.pr[x + i];
      oc[i] = different.pr[x + i + 1];
      od[i] = different.ps[x + i];
      oe[i] = different.qr[x + i];
      of[i] = different.rs[x + i];
    }
    std::uint16_t ca[kN], cb[kN], cc[kN], cd[kN], ce[kN], cf[kN];  // the edges to close
    for (int i = 0; i < kN; ++i) {
      const auto mask = [](bool value) { return static_cast<std::uint16_t>(value ? 0xFFFF : 0); };
      const std::uint16_t a_c = mask(a[i] <= c[i]), a_d = mask(a[i] <= d[i]), c_d = mask(c[i] <= d[i]);
      const std::uint16_t b_d = mask(b[i] <= d[i]), b_f = mask(b[i] <= f[i]), d_f = mask(d[i] <= f[i]);
      const std::uint16_t a_b = mask(a[i] <= b[i]), a_e = mask(a[i] <= e[i]), b_e = mask(b[i] <= e[i]);
      const std::uint16_t c_e = mask(c[i] <= e[i]), c_f = mask(c[i] <= f[i]), e_f = mask(e[i] <= f[i]);
      ca[i] = static_cast<std::uint16_t>((~od[i] & ~a_c) | (~oc[i] & ~a_d) | (~oe[i] & ~a_b) | (~ob[i] & ~a_e));
      cb[i] = static_cast<std::uint16_t>((~of[i] & ~b_d) | (~od[i] & ~b_f) | (~oe[i] & a_b) | (~oa[i] & ~b_e));
      cc[i] = static_cast<std::uint16_t>((~od[i] & a_c) | (~oa[i] & ~c_d) | (~of[i] & ~c_e) | (~oe[i] & ~c_f));
      cd[i] = static_cast<std::uint16_t>((~oc[i] & a_d) | (~oa[i] & c_d) | (~of[i] & b_d) | (~ob[i] & ~d_f));
      ce[i] = static_cast<std::uint16_t>((~ob[i] & a_e) | (~oa[i] & b_e) | (~of[i] & c_e) | (~oc[i] & ~e_f));
      cf[i] = static_cast<std::uint16_t>((~od[i] & b_f) | (~ob[i] & d_f) | (~oe[i] & c_f) | (~oc[i] & e_f));
    }
    for (int i = 0; i < kN; ++i) {
      open.pq[x + i] &= static_cast<std::uint16_t>(~ca[i]);
      open.pr[x + i] &= static_cast<std::uint16_t>(~cb[i]);
      open.ps[x + i] &= static_cast<std::uint16_t>(~cd[i]);
      open.qr[x + i] &= static_cast<std::uint16_t>(~ce[i]);
      open.rs[x + i] &= static_cast<std::uint16_t>(~cf[i]);
    }
    for (int i = 0; i < kN; ++i) {
      open.pr[x + i + 1] &= static_cast<std::uint16_t>(~cc[i]);
    }
  }
}

}  // namespace

void OpenEdges::begin(const ColorEdges& edges, const std::int32_t* components, std::ptrdiff_t stride) {
  edges_ = &edges;
  components_ = components;
  stride_ = stride;
  row_ = -1;
  const std::size_t length = static_cast<std::size_t>(edges.size().width + ColorEdges::kPadding);
  for (Rows* rows : {&open_, &different_}) {
    for (std::vector<std::uint16_t>& row : *rows) {
      row.resize(length);
    }
  }
  next_open_right_.resize(length);
  next_different_right_.resize(length);
  markDifferent(components, components + 1, edges.size().width, next_different_right_.data());
  next_open_right_ = next_different_right_;
}

void OpenEdges::nextRow() {
  ++row_;
  std::swap(open_[0], next_open_right_);
  std::swap(different_[0], next_different_right_);
  if (row_ + 1 == edges_->size().height) {
    return;
  }
  const int width = edges_->size().width;
  const std::int32_t* here = components_ + row_ * stride_;
  const std::int32_t* below = here + stride_;
  markDifferent(here, below, width, different_[1].data());
  markDifferent(here, below + 1, width, different_[2].data());
  markDifferent(here + 1, below, width, different_[3].data() + 1);  // of the pixel to the left, from column 1 on
  markDifferent(below, below + 1, width, next_different_right_.data());
  std::copy(different_.begin() + 1, different_.end(), open_.begin() + 1);
  next_open_right_ = next_different_right_;
  closeLater({edges_->steps(row_, 0), edges_->steps(row_, 1), edges_->steps(row_, 2), edges_->steps(row_, 3) + 1,
              edges_->steps(row_ + 1, 0)},
             masksOf(different_, next_different_right_), masksOf(open_, next_open_right_), width);
}

}  // namespace saccade
