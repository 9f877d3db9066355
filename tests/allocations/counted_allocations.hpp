#pragma once

#include <cstddef>

namespace saccade::test {

/// Allocations from the heap that this thread made so far, by malloc, its kin and operator new.
[[nodiscard]] std::size_t allocationsSoFar();

}  // namespace saccade::test
