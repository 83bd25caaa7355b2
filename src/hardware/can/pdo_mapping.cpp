#include "pdo_mapping.h"

namespace knee_robot::hardware::can {
namespace {

constexpr std::uint32_t kInvalid = 0x80000000;
constexpr std::uint32_t kNoRemoteRequest = 0x40000000;  // drives without remote frames insist on it in a transmit PDO

std::uint16_t communication(bool transmit, int number) {
  return static_cast<std::uint16_t>((transmit ? objects::kTransmitPdo : objects::kReceivePdo) + number);
}
std::uint16_t mapping(bool transmit, int number) {
  return static_cast<std::uint16_t>((transmit ? objects::kTransmitPdoMapping : objects::kReceivePdoMapping) + number);
}
std::uint32_t identifier(bool transmit, std::uint32_t id) {
  return transmit ? id | kNoRemoteRequest : id;
}

}  // namespace

int Pdo::bytes() const {
  int bits = 0;
  for (const MappedObject& mapped : objects)
    bits += mapped.bits;
  return bits / 8;
}

void disable(SdoClient& client, bool transmit, int number, std::uint32_t id) {
  client.write<std::uint32_t>(objects::object(communication(transmit, number), 1), identifier(transmit, id) | kInvalid);
}

void configure(SdoClient& client, const Pdo& pdo) {
  const std::uint16_t parameters = communication(pdo.transmit, pdo.number);
  const std::uint16_t map = mapping(pdo.transmit, pdo.number);
  disable(client, pdo.transmit, pdo.number, pdo.id);
  client.write<std::uint8_t>(objects::object(map, 0), 0);
  std::uint8_t count = 0;
  for (const MappedObject& mapped : pdo.objects) {
    ++count;
    const std::uint32_t entry = mapped.object << 8 | static_cast<std::uint32_t>(mapped.bits);
    client.writeChecked<std::uint32_t>(objects::object(map, count), entry);
  }
  client.writeChecked<std::uint8_t>(objects::object(map, 0), count);
  client.writeChecked<std::uint8_t>(objects::object(parameters, 2), pdo.type);
  if (pdo.transmit) client.writeChecked<std::uint16_t>(objects::object(parameters, 3), 0);
  client.write<std::uint32_t>(objects::object(parameters, 1), identifier(pdo.transmit, pdo.id));
  // Whether remote requests are allowed is the drive's to say; identifier and validity must be ours.
  const auto found = client.read<std::uint32_t>(objects::object(parameters, 1));
  if ((found & ~kNoRemoteRequest) != pdo.id) {
    throw SdoError("node " + std::to_string(client.node()) + ", object " + objectName(objects::object(parameters, 1)) +
                       ": the PDO does not become valid",
                   0);
  }
}

}  // namespace knee_robot::hardware::can
