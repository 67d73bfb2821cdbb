/// Counts what is taken from the heap. To be included by one source file of a test program.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

namespace servomill {
inline std::size_t allocations = 0;
}

// Not inlined, or the compiler sees free() at the end of what it takes for the library's new.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++servomill::allocations;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
