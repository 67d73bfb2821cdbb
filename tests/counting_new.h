/// Counts what is taken from the heap. To be included by one source file of a test program.
#pragma once

#include <malloc.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace servomill {
inline std::size_t allocations = 0;
inline std::size_t bytes_in_use = 0;
inline std::size_t most_bytes_in_use = 0;  // to be set to bytes_in_use where counting begins

inline void* counted(void* p) {
  if (p == nullptr) throw std::bad_alloc();
  ++allocations;
  bytes_in_use += malloc_usable_size(p);
  most_bytes_in_use = std::max(most_bytes_in_use, bytes_in_use);
  return p;
}
inline void uncounted(void* p) {
  bytes_in_use -= malloc_usable_size(p);
  std::free(p);
}
}  // namespace servomill

// Not inlined, or the compiler sees free() at the end of what it takes for the library's new.
[[gnu::noinline]] void* operator new(std::size_t size) {
  return servomill::counted(std::malloc(size));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto align = static_cast<std::size_t>(alignment);
  return servomill::counted(std::aligned_alloc(align, (size + align - 1) / align * align));
}
[[gnu::noinline]] void operator delete(void* p) noexcept { servomill::uncounted(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { servomill::uncounted(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept {
  servomill::uncounted(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  servomill::uncounted(p);
}
