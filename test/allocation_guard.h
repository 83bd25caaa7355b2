#pragma once
// Replaces operator new and delete of the whole test program and counts what a thread does while it is `armed`. Include it in one
// source file of a program only.

#include <cstdlib>
#include <new>

namespace {

/// This thread's allocations and releases are counted.
thread_local bool armed = false;
long allocations = 0;

void* counted(std::size_t size) {
  if (armed) ++allocations;
  void* memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
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
