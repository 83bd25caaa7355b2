#include "knee_robot/hardware/can/object_dictionary.h"

#include <algorithm>
#include <cstdlib>

#include "knee_robot/base/strict_yaml.h"

namespace knee_robot::hardware::can {
namespace {

/// The whole of `text` as a number; C's prefixes.
bool parseNumber(const std::string& text, int base, long long& value) {
  char* end = nullptr;
  value = std::strtoll(text.c_str(), &end, base);
  return !text.empty() && *end == '\0';
}

DictionaryEntry readEntry(StrictMap& map) {
  DictionaryEntry entry;
  const std::string name = map.text("object");
  long long index = 0;
  long long subindex = 0;
  const std::size_t colon = name.find(':');
  const bool good = colon != std::string::npos && parseNumber(name.substr(0, colon), 16, index) &&
                    parseNumber(name.substr(colon + 1), 16, subindex) && index > 0 && index <= 0xFFFF &&
                    subindex >= 0 && subindex <= 0xFF;
  if (!good) map.refuse("object", "must be index:subindex in hexadecimal digits, as in \"6041:00\"");
  entry.object = objects::object(static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(subindex));
  const std::string type = map.choice("type", {"u8", "u16", "u32", "i8", "i16", "i32"});
  entry.is_signed = type[0] == 'i';
  entry.size = std::atoi(type.c_str() + 1) / 8;
  const std::string access = map.choiceOr("access", "ro", {"ro", "rw", "wo"});
  entry.readable = access != "wo";
  entry.writable = access != "ro";
  entry.mappable = map.flagOr("mappable", false);
  long long value = 0;
  const std::string text = map.textOr("value", "0");
  const long long span = 1LL << (8 * entry.size);
  const long long lowest = entry.is_signed ? -span / 2 : 0;
  if (!parseNumber(text, 0, value) || value < lowest || value >= lowest + span) {
    map.refuse("value", text + " is no number that fits into " + type);
  }
  entry.value = static_cast<std::uint32_t>(value);
  map.textOr("name", "");
  map.finish();
  return entry;
}

bool before(const DictionaryEntry& entry, objects::Object object) noexcept {
  return entry.object < object;
}

}  // namespace

ObjectDictionary ObjectDictionary::load(const std::string& path) {
  StrictMap file = StrictMap::load(path);
  ObjectDictionary dictionary;
  for (StrictMap& map : file.maps("objects")) {
    const DictionaryEntry entry = readEntry(map);
    if (dictionary.find(entry.object) != nullptr) map.refuse("object", objectName(entry.object) + " is listed twice");
    auto& entries = dictionary.entries_;
    entries.insert(std::lower_bound(entries.begin(), entries.end(), entry.object, before), entry);
  }
  file.finish();
  return dictionary;
}

const DictionaryEntry* ObjectDictionary::find(objects::Object object) const noexcept {
  const auto found = std::lower_bound(entries_.begin(), entries_.end(), object, before);
  return found != entries_.end() && found->object == object ? &*found : nullptr;
}

DictionaryEntry* ObjectDictionary::find(objects::Object object) noexcept {
  return const_cast<DictionaryEntry*>(static_cast<const ObjectDictionary*>(this)->find(object));
}

bool ObjectDictionary::hasIndex(std::uint16_t index) const noexcept {
  const auto found = std::lower_bound(entries_.begin(), entries_.end(), objects::object(index), before);
  return found != entries_.end() && objects::indexOf(found->object) == index;
}

std::int64_t ObjectDictionary::get(objects::Object object) const noexcept {
  const DictionaryEntry* entry = find(object);
  if (entry == nullptr) return 0;
  const int bits = 8 * entry->size;
  const std::int64_t value = entry->value & ((1ULL << bits) - 1);
  const bool negative = entry->is_signed && (value >> (bits - 1) & 1) != 0;
  return negative ? value - (1LL << bits) : value;
}

void ObjectDictionary::set(objects::Object object, std::int64_t value) noexcept {
  if (DictionaryEntry* entry = find(object)) entry->value = static_cast<std::uint32_t>(value);
}

std::uint32_t ObjectDictionary::checkRead(objects::Object object) const noexcept {
  const DictionaryEntry* entry = find(object);
  if (entry != nullptr) return entry->readable ? 0 : kSdoWriteOnly;
  return hasIndex(objects::indexOf(object)) ? kSdoNoSubindex : kSdoNoObject;
}

std::uint32_t ObjectDictionary::checkWrite(objects::Object object, int size) const noexcept {
  const DictionaryEntry* entry = find(object);
  if (entry == nullptr) return hasIndex(objects::indexOf(object)) ? kSdoNoSubindex : kSdoNoObject;
  if (!entry->writable) return kSdoReadOnly;
  return size == entry->size ? 0 : kSdoWrongSize;
}

}  // namespace knee_robot::hardware::can
