#include "test/allocation_guard.h"

#include <cstdlib>
#include <new>

namespace allocation_guard {

thread_local bool armed = false;
long allocations = 0;

namespace {

void* counted(std::size_t size) {
  if (armed) ++allocations;
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace
}  // namespace allocation_guard

void* operator new(std::size_t size) {
  return allocation_guard::counted(size);
}
void* operator new[](std::size_t size) {
  return allocation_guard::counted(size);
}
void operator delete(void* memory) noexcept {
  if (armed) ++allocations;
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  operator delete(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  operator delete(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  operator delete(memory);
}
