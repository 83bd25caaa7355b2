// SysfsPort on a folder that looks like /sys/bus/pci/devices: plain files stand for the cards' registers.
#include "src/hardware/sysfs_port.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "knee_robot/base/errors.h"
#include "knee_robot/hardware/pci1720.h"
#include "knee_robot/hardware/pci1720_registers.h"
#include "test/refusal.h"
#include "test/temporary_folder.h"

namespace knee_robot::hardware {
namespace {

namespace fs = std::filesystem;

class SysfsPortTest : public ::testing::Test {
 protected:
  fs::path addCard(const std::string& address, const std::string& device, char board_id) {
    const fs::path folder = root_ / address;
    fs::create_directories(folder);
    std::ofstream(folder / "vendor") << "0x13fe\n";
    std::ofstream(folder / "device") << device << "\n";
    std::ofstream(folder / "enable") << "0\n";
    std::string registers(32, '\0');
    registers[pci1720::kBoardId] = board_id;
    std::ofstream(folder / "resource2", std::ios::binary) << registers;
    return folder;
  }
  CardQuery query(std::optional<int> board_id) const {
    CardQuery result;
    result.vendor = pci1720::kVendor;
    result.device = pci1720::kDevice;
    result.board_id_offset = pci1720::kBoardId;
    result.board_id = board_id;
    result.devices = root_.string();
    return result;
  }
  std::string refusal(std::optional<int> board_id) const {
    return refusalOf([&] { SysfsPort::find(query(board_id)); });
  }
  static std::string content(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  const TemporaryFolder folder_;
  const fs::path root_ = folder_.path();
};

TEST_F(SysfsPortTest, FindsTheCardOfTheAskedKindAndBoardIdAndEnablesIt) {
  addCard("0000:04:00.0", "0x1784", 2);
  addCard("0000:04:01.0", "0x1720", 1);
  const fs::path wanted = addCard("0000:04:02.0", "0x1720", 2);
  const auto port = SysfsPort::find(query(2));
  EXPECT_EQ(port->folder(), wanted.string());
  EXPECT_EQ(content(wanted / "enable")[0], '1');
}

TEST_F(SysfsPortTest, LeavesACardThatIsEnabledAsItIsBecauseOnlyRootMayWriteThere) {
  const fs::path card = addCard("0000:04:01.0", "0x1720", 1);
  std::ofstream(card / "enable") << "3\n";
  SysfsPort::find(query(1));
  EXPECT_EQ(content(card / "enable"), "3\n") << "the count of those who enabled it";
}

TEST_F(SysfsPortTest, SaysWhatEnablesACardThatThisUserMayNotEnable) {
  const fs::path card = addCard("0000:04:01.0", "0x1720", 1);
  fs::remove(card / "enable");
  fs::create_directory(card / "enable");  // nobody writes there, not even root
  EXPECT_NE(refusal(1).find("run scripts/set_up_industrial_pc"), std::string::npos) << refusal(1);
}

TEST_F(SysfsPortTest, PutsTheBytesOfTheDriverWhereTheRegisterTableSays) {
  const fs::path card = addCard("0000:04:01.0", "0x1720", 4);
  const auto port = SysfsPort::find(query(std::nullopt));
  Pci1720 analog(*port);
  std::vector<std::string> findings;
  ASSERT_TRUE(analog.initialise(findings)) << findings.back();
  std::array<double, 4> written{};
  ASSERT_EQ(analog.writeVolts({-10.0, 0.0, 5.0, 9.9}, written), IoStatus::Ok);
  const std::string bytes = content(card / "resource2");
  const std::string expected("\x00\x00\x00\x08\x00\x0C\xEC\x0F", 8);  // 0x000, 0x800, 0xC00, 0xFEC, low byte first
  EXPECT_EQ(bytes.substr(0, 8), expected);
  EXPECT_EQ(static_cast<unsigned char>(bytes[pci1720::kRange]), 0xFF);
  EXPECT_EQ(bytes[pci1720::kSynchronousMode], 1);
}

TEST_F(SysfsPortTest, ReportsAnAccessBeyondTheCardAsDisconnected) {
  addCard("0000:04:01.0", "0x1720", 4);
  const auto port = SysfsPort::find(query(std::nullopt));
  std::uint32_t word = 5;
  EXPECT_EQ(port->read32(30, word), IoStatus::Disconnected);
  EXPECT_EQ(word, 5u);
}

TEST_F(SysfsPortTest, SaysWhatIsMissing) {
  EXPECT_NE(refusal(std::nullopt).find("no PCI card 13fe:1720"), std::string::npos);
  addCard("0000:04:01.0", "0x1720", 1);
  EXPECT_NE(refusal(3).find("board id 3 (found: 1)"), std::string::npos) << refusal(3);
  addCard("0000:04:02.0", "0x1720", 2);
  EXPECT_NE(refusal(std::nullopt).find("say which by its board id"), std::string::npos);
}

TEST_F(SysfsPortTest, RefusesACardThatAKernelDriverHasClaimed) {
  const fs::path card = addCard("0000:04:01.0", "0x1720", 1);
  fs::create_directory_symlink("../../drivers/adv_pci1720", card / "driver");
  EXPECT_NE(refusal(std::nullopt).find("adv_pci1720 has claimed"), std::string::npos) << refusal(std::nullopt);
}

}  // namespace
}  // namespace knee_robot::hardware
