#include "knee_robot/recording/import.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/recording/recording.h"
#include "test/refusal.h"
#include "test/temporary_folder.h"

namespace knee_robot::recording {
namespace {

namespace fs = std::filesystem;

std::string sharedData() {
  const char* folder = std::getenv("KNEE_SHARED_DIR");
  return folder ? std::string(folder) + "/data" : KNEE_SOURCE_DIR "/../shared/data";
}

/// A folder that goes away with the test.
class ImportTest : public ::testing::Test {
 protected:
  /// Two axes, 10 ms, every signal in its own file; commands 2 ms after positions, references 1 ms.
  SignalFolder write(int rows = 50, int lost_command = -1) const {
    std::string position = "time_sec\ttime_nanosec\tq_0\tq_1\n", command = position, reference = position;
    for (int i = 0; i < rows; ++i) {
      const auto row = [&](int ms, double a, double b) {
        const long long ns = 1600000000999000000LL + i * 10000000LL + ms * 1000000LL;
        return std::to_string(ns / 1000000000) + "\t" + std::to_string(ns % 1000000000) + "\t" + std::to_string(a) +
               "\t" + std::to_string(b) + "\n";
      };
      position += row(0, 0.7 + 0.001 * i, 0.8);
      if (i != lost_command) command += row(2, i, -i);
      reference += row(1, 0.7, 0.8);
    }
    writeFileAtomically(folder_ + "/joint_position.txt", position);
    writeFileAtomically(folder_ + "/control_action.txt", command);
    writeFileAtomically(folder_ + "/ref_pose.txt", reference);
    SignalFolder signals;
    signals.path = folder_;
    signals.command_unit = "V";
    return signals;
  }

  const TemporaryFolder folder_;
};

TEST_F(ImportTest, ARowTakesTheCommandThatWasWrittenAfterItsPosition) {
  const Recording r = parseRecording(importFolder(write()).csv, "imported");
  ASSERT_EQ(r.rows(), 50);
  EXPECT_EQ(r.axes, 2);
  for (int i = 0; i < r.rows(); ++i) {
    EXPECT_NEAR(r.time_s[static_cast<std::size_t>(i)], 0.01 * i, 1e-12);
    EXPECT_EQ(r.command_V(i, 0), i);
    EXPECT_EQ(r.command_V(i, 1), -i);
    EXPECT_NEAR(r.position_m(i, 0), 0.7 + 0.001 * i, 1e-12);
  }
}

TEST_F(ImportTest, ALostCommandIsHeldAndReported) {
  const Imported imported = importFolder(write(50, 20));
  const Recording r = parseRecording(imported.csv, "imported");
  EXPECT_EQ(r.command_V(19, 0), 19);
  EXPECT_EQ(r.command_V(20, 0), 19);
  EXPECT_EQ(r.command_V(21, 0), 21);
  bool told = false;
  for (const std::string& note : imported.notes)
    told = told || note.find("held over 1 rows") != std::string::npos;
  EXPECT_TRUE(told);
}

TEST_F(ImportTest, StaleLeadingRowsAreDroppedAndReported) {
  SignalFolder signals = write();
  const std::string path = folder_ + "/joint_position.txt";
  std::string content = readFile(path);
  content.insert(content.find('\n') + 1, "1500000000\t5\t0.1\t0.1\n1500000000\t5\t0.1\t0.1\n");
  writeFileAtomically(path, content);
  const Imported imported = importFolder(signals);
  EXPECT_EQ(imported.rows, 50);
  EXPECT_NE(imported.notes.at(1).find("first 2 rows were stale"), std::string::npos) << imported.notes.at(1);
}

TEST_F(ImportTest, ALastLineThatIsCutOffIsLeftOutAndReported) {
  const SignalFolder signals = write();
  const std::string path = folder_ + "/control_action.txt", content = readFile(path);
  for (const std::size_t lost : {3u, 12u}) {
    writeFileAtomically(path, content.substr(0, content.size() - lost));
    const Imported imported = importFolder(signals);
    EXPECT_EQ(imported.rows, 49);
    const auto told = [](const std::string& note) {
      return note.find("control_action.txt: the last line (51) is cut off and was left out.") != std::string::npos;
    };
    EXPECT_TRUE(std::any_of(imported.notes.begin(), imported.notes.end(), told));
  }
}

TEST_F(ImportTest, FilesOfDifferentRunsAreRefused) {
  const SignalFolder signals = write();
  std::string other = "time_sec\ttime_nanosec\tq_0\tq_1\n";
  for (int i = 0; i < 50; ++i)
    other += std::to_string(1700000000 + i) + "\t0\t1\t1\n";
  writeFileAtomically(folder_ + "/control_action.txt", other);
  EXPECT_THROW(importFolder(signals), Refusal);
}

TEST_F(ImportTest, AWrongValueIsNamedByFileLineAndColumn) {
  const SignalFolder signals = write();
  const std::string path = folder_ + "/control_action.txt";
  std::string content = readFile(path);
  content.replace(content.find("\t7.000000"), 9, "\tseven");
  writeFileAtomically(path, content);
  const std::string message = refusalOf([&] { importFolder(signals); });
  EXPECT_NE(message.find("control_action.txt:9: column 'q_0': 'seven' is not a finite number"), std::string::npos)
      << message;
}

TEST_F(ImportTest, ARecordingIsNeverOverwritten) {
  const Imported imported = importFolder(write());
  writeImported(imported, folder_ + "/run.csv");
  EXPECT_NE(refusalOf([&] { writeImported(imported, folder_ + "/run.csv"); }).find("exists already"),
            std::string::npos);
  EXPECT_EQ(readFile(folder_ + "/run.csv"), imported.csv);
}

TEST_F(ImportTest, TheLaboratorysFolderBecomesTheAlignedRecordingOfTheSameRun) {
  const std::string raw = sharedData() + "/raw/exp_20_01_2021-16_15_33";
  const std::string aligned = sharedData() + "/measured/B_N_20_01_2021_161533.csv";
  if (!fs::exists(raw) || !fs::exists(aligned)) GTEST_SKIP() << raw << " or the aligned recording is absent";
  SignalFolder signals;
  signals.path = raw;
  signals.command_unit = "N";
  const Recording ours = parseRecording(importFolder(signals).csv, "imported");
  const Recording theirs = loadRecording(aligned);
  ASSERT_EQ(ours.rows(), theirs.rows());
  double time = 0.0;
  for (int i = 0; i < ours.rows(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    time = std::max(time, std::abs(ours.time_s[k] - theirs.time_s[k]));
  }
  const double position = (ours.position_m - theirs.position_m).cwiseAbs().maxCoeff();
  const double reference = (ours.reference_m - theirs.reference_m).cwiseAbs().maxCoeff();
  const double force = (ours.force_N - theirs.force_N).cwiseAbs().maxCoeff();
  RecordProperty("stamps_us", std::to_string(1e6 * time));
  std::cout << "largest differences over " << ours.rows() << " rows: stamps " << 1e6 * time << " us, positions "
            << 1e6 * position << " um, references " << 1e6 * reference << " um, forces " << force << " N\n";
  EXPECT_LT(time, 1.01e-6) << "the aligned file prints microseconds";
  EXPECT_LT(position, 1e-9);
  EXPECT_LT(reference, 1e-9);
  EXPECT_LT(force, 1e-9);
}

constexpr const char* kTable =
    "Some recorder\r\n"
    "\"t [ms]\";\"enc 1\";u;\"x [mm]\"\r\n"
    "1000,5;200;1,5;\r\n"
    "1010,5;210;-1,5;12,5\r\n"
    "1025;220;0;nan\r\n\r\n";

constexpr const char* kColumnMap =
    "separator: semicolon\n"
    "decimal: comma\n"
    "skip_lines: 1\n"
    "columns:\n"
    "  - {from: 't [ms]', to: time_s, unit: ms}\n"
    "  - {from: enc 1, to: position_1_m, unit: counts, scale: 5e-6, offset: 0.6}\n"
    "  - {from: u, to: command_1_V}\n"
    "  - {from: 'x [mm]', to: mocap_x_m, unit: mm}\n"
    "  - {from: 'x [mm]', to: mocap_z_m, unit: mm, scale: -1}\n"
    "  - {from: 'x [mm]', to: mocap_theta_rad, unit: deg}\n"
    "  - {from: 'x [mm]', to: mocap_psi_rad}\n";

TEST(ImportTable, AppliesUnitsScalesAndOffsets) {
  const ColumnMap map = parseColumnMap(kColumnMap, "map.yaml");
  const Recording r = parseRecording(importTable(TextTable(kTable, "log.csv", map.format), map).csv, "imported");
  ASSERT_EQ(r.rows(), 3);
  EXPECT_NEAR(r.time_s[1], 0.01, 1e-12);
  EXPECT_NEAR(r.time_s[2], 0.0245, 1e-12);
  EXPECT_NEAR(r.position_m(2, 0), 0.6 + 220 * 5e-6, 1e-12);
  EXPECT_EQ(r.command_V(1, 0), -1.5);
  EXPECT_TRUE(std::isnan(r.mocap(0, 0)) && std::isnan(r.mocap(2, 0)));
  EXPECT_NEAR(r.mocap(1, 0), 0.0125, 1e-12);
  EXPECT_NEAR(r.mocap(1, 1), -0.0125, 1e-12);
  EXPECT_NEAR(r.mocap(1, 2), 12.5 * M_PI / 180.0, 1e-12);
}

TEST(ImportTable, AddsSecondsAndNanosecondsWithoutLosingDigits) {
  ColumnMap map;
  map.format.header = false;
  for (const char* text : {"1=time_s,s", "2=time_s,ns", "3=position_1_m,mm", "4=force_1_N,kN"})
    map.columns.push_back(parseMapping(text));
  const TextTable table("1611155761 990000001 700 1\n1611155762 000000003 701 2\n", "log.txt", map.format);
  const Recording r = parseRecording(importTable(table, map).csv, "imported");
  EXPECT_NEAR(r.time_s[1], 0.010000002, 1e-12);
  EXPECT_NEAR(r.position_m(1, 0), 0.701, 1e-12);
  EXPECT_EQ(r.force_N(1, 0), 2000.0);
}

TEST(ImportTable, SaysWhatIsWrongByFileLineAndColumn) {
  const ColumnMap map = parseColumnMap(kColumnMap, "map.yaml");
  const auto with = [&](const std::string& find, const std::string& put) {
    std::string content = kTable;
    content.replace(content.find(find), find.size(), put);
    return refusalOf([&] { importTable(TextTable(content, "log.csv", map.format), map); });
  };
  EXPECT_NE(with("210", "2x0").find("log.csv:4: column 'enc 1': '2x0' is not a finite number"), std::string::npos);
  EXPECT_NE(with("1025", "1005").find("log.csv:5: column 't [ms]': time does not increase"), std::string::npos);
  EXPECT_NE(with(";12,5", "").find("log.csv:4: 3 values where the first line has 4"), std::string::npos);
  EXPECT_NE(with("enc 1", "enc 2").find("log.csv:2: column 'enc 1' is missing; there are 't [ms]', 'enc 2'"),
            std::string::npos);
  EXPECT_NE(with("220", "").find("column 'enc 1': '' is not a finite number"), std::string::npos);
}

TEST(ColumnMapFile, RefusesWhatItCannotMean) {
  const auto with = [&](const std::string& line) {
    return refusalOf([&] { parseColumnMap("columns:\n  - " + line + "\n", "map.yaml"); });
  };
  EXPECT_NE(with("{from: a, to: positon_1_m}").find("map.yaml:2"), std::string::npos);
  EXPECT_NE(with("{from: a, to: position_1_m, unit: deg}").find("'deg' does not fit position_1_m; known: "),
            std::string::npos);
  EXPECT_NE(with("{from: a, to: position_1_m, unit: counts}").find("counts need a scale"), std::string::npos);
  EXPECT_NE(with("{from: a, to: time_s, scale: 0}").find("not 0"), std::string::npos);
  EXPECT_NE(with("{from: a, to: time_s, units: s}").find("unknown key units"), std::string::npos);
  EXPECT_NE(refusalOf([] { parseMapping("a=position_1_m,mm,x"); }).find("'x' is not a finite number"),
            std::string::npos);
}

std::string mutated(std::string text, std::mt19937& random) {
  static const std::string kBytes = "\t\n\r ;,.-+0129eEnai{}[]:'\"\0\xff";
  const int edits = 1 + static_cast<int>(random() % 4);
  for (int i = 0; i < edits && !text.empty(); ++i) {
    const std::size_t at = random() % text.size();
    switch (random() % 4) {
      case 0:
        text[at] = kBytes[random() % kBytes.size()];
        break;
      case 1:
        text.erase(at, 1 + random() % 12);
        break;
      case 2:
        text.insert(at, text.substr(random() % text.size(), 1 + random() % 20));
        break;
      default:
        text.resize(at);
    }
  }
  return text;
}

/// Either a recording that the reader accepts, or one of the two declared errors.
void mustBeSound(const std::function<Imported()>& import, int& accepted) {
  try {
    const Imported imported = import();
    ASSERT_EQ(parseRecording(imported.csv, "imported").rows(), imported.rows);
    ++accepted;
  } catch (const InputError&) {
  } catch (const Refusal&) {
  }
}

TEST(ImportTable, MutatedTablesAndMapsGiveASoundRecordingOrADeclaredError) {
  std::mt19937 random(7);
  int accepted = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::string table = i % 2 == 0 ? mutated(kTable, random) : kTable;
    const std::string text = i % 2 == 1 ? mutated(kColumnMap, random) : kColumnMap;
    mustBeSound(
        [&] {
          const ColumnMap map = parseColumnMap(text, "map.yaml");
          return importTable(TextTable(table, "log.csv", map.format), map);
        },
        accepted);
  }
  EXPECT_GT(accepted, 100) << "the mutations are too coarse to test anything beyond the first check";
}

TEST(ImportTable, LeavesOutALastLineThatIsCutOff) {
  ColumnMap map;
  map.columns = {parseMapping("t=time_s"), parseMapping("q=position_1_m,mm"), parseMapping("f=force_1_N")};
  const std::string table = "t,q,f\n0,1,444.105\n1,2,444.789\n2,3,445.213";
  const auto rows = [&](std::size_t lost) {
    const std::string content = table.substr(0, table.size() - lost);
    const Imported imported = importTable(TextTable(content, "log.csv", map.format), map);
    EXPECT_EQ(imported.notes.front().find("the last line (4) is cut off") != std::string::npos, imported.rows < 3);
    return imported.rows;
  };
  EXPECT_EQ(rows(0), 3) << "only its line break is missing";
  for (const std::size_t lost : {1u, 6u, 7u, 8u, 10u})
    EXPECT_EQ(rows(lost), 2) << lost;
}

TEST(ImportTable, KeepsALastLineThatEndsInAWord) {
  const TextTable table("q,mode\n1,running\n2,ok", "log.csv", {});
  EXPECT_EQ(table.rows(), 2);
  EXPECT_TRUE(table.notes().empty());
}

TEST(ImportTable, ReadsColumnsOfChainsInTheirUnits) {
  ColumnMap map;
  for (const char* text : {"t=time_s,ms", "q=position_1_rad,deg", "v=velocity_1_rad_per_s,rpm", "m=torque_1_Nm,mNm",
                           "i=current_1_A,mA", "w=temperature_1_degC"})
    map.columns.push_back(parseMapping(text));
  const TextTable table("t,q,v,m,i,w\n0,180,60,1500,250,30\n10,90,30,500,125,31\n", "log.csv", {});
  const Recording r = parseRecording(importTable(table, map).csv, "imported");
  EXPECT_NEAR(r.position_m(0, 0), M_PI, 1e-12);
  EXPECT_NEAR(r.velocity_m_per_s(0, 0), 2.0 * M_PI, 1e-12);
  EXPECT_NEAR(r.force_N(0, 0), 1.5, 1e-12);
  EXPECT_NEAR(r.current_A(1, 0), 0.125, 1e-12);
  EXPECT_NEAR(r.temperature_degC(1, 0), 31.0, 1e-12);
  EXPECT_EQ(parseMapping("q=position_12_rad,deg").to, "position_12_rad");
  for (const char* wrong : {"q=position_13_rad", "q=position_0_rad", "q=torque_1_N", "q=position_1_rad,mm"})
    EXPECT_THROW(parseMapping(wrong), InputError) << wrong;
}

TEST(ImportTable, ReadsQuotedCells) {
  ColumnMap map;
  for (const char* text : {"t, \"s\"=time_s", "x=position_1_m", "f=force_1_N"})
    map.columns.push_back(parseMapping(text));
  map.format.decimal_comma = true;
  map.format.separator = ',';
  const TextTable table("\"t, \"\"s\"\"\", \"x\" ,f\r\n\"0,0\",\"0,25\", \"3\"\r\n\"0,1\",\"0,5\",4\r\n", "log.csv",
                        map.format);
  const Recording r = parseRecording(importTable(table, map).csv, "imported");
  ASSERT_EQ(r.rows(), 2);
  EXPECT_EQ(r.time_s[1], 0.1);
  EXPECT_EQ(r.position_m(0, 0), 0.25);
  EXPECT_EQ(r.force_N(0, 0), 3.0);
  EXPECT_EQ(r.force_N(1, 0), 4.0);
  EXPECT_THROW(TextTable("a,b\n\"1\"2,3\n", "log.csv", {}).numbers(0), InputError);
}

/// Without waiting for the disk.
void writePlainly(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

TEST_F(ImportTest, MutatedFoldersGiveASoundRecordingOrADeclaredError) {
  std::mt19937 random(11);
  int accepted = 0;
  const SignalFolder signals = write(12);
  const char* const files[] = {"/joint_position.txt", "/control_action.txt", "/ref_pose.txt"};
  std::string whole[3];
  for (int f = 0; f < 3; ++f)
    whole[f] = readFile(folder_ + files[f]);
  for (int i = 0; i < 1500; ++i) {
    const int f = i % 3;
    writePlainly(folder_ + files[f], mutated(whole[f], random));
    mustBeSound([&] { return importFolder(signals); }, accepted);
    writePlainly(folder_ + files[f], whole[f]);
  }
  EXPECT_GT(accepted, 20);
}

}  // namespace
}  // namespace knee_robot::recording
