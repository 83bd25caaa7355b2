#pragma once

#include <string>
#include <vector>

#include "knee_robot/hardware/can/sdo.h"

namespace knee_robot::hardware::can {

/// One object of a simulated drive.
struct DictionaryEntry {
  objects::Object object = 0;
  int size = 0;  ///< bytes: 1, 2 or 4
  bool is_signed = false;
  bool readable = true;
  bool writable = false;
  bool mappable = false;
  std::uint32_t value = 0;  ///< its low `size` bytes
};

/// Objects of a simulated drive, from a table:
///
///     objects:
///       - {object: "6041:00", type: u16, access: ro, value: 0x0240, mappable: true, name: status word}
///
/// type: u8 u16 u32 i8 i16 i32; access: ro rw wo. Looking up is real-time safe.
class ObjectDictionary {
 public:
  /// Throws InputError.
  static ObjectDictionary load(const std::string& path);

  /// Nothing when it does not exist.
  DictionaryEntry* find(objects::Object object) noexcept;
  const DictionaryEntry* find(objects::Object object) const noexcept;
  bool hasIndex(std::uint16_t index) const noexcept;

  /// Value, sign-extended; 0 when it does not exist.
  std::int64_t get(objects::Object object) const noexcept;
  /// Whatever the access; nothing happens when it does not exist.
  void set(objects::Object object, std::int64_t value) noexcept;

  /// As a service data server answers: the object's access, existence and size. 0 or an abort code.
  std::uint32_t checkRead(objects::Object object) const noexcept;
  std::uint32_t checkWrite(objects::Object object, int size) const noexcept;

 private:
  std::vector<DictionaryEntry> entries_;  // sorted by object
};

}  // namespace knee_robot::hardware::can
