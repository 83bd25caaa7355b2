#include "knee_robot/recording/recording_writer.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>

#include "knee_robot/base/errors.h"
#include "knee_robot/base/files.h"
#include "knee_robot/recording/recording.h"
#include "test/temporary_folder.h"

namespace knee_robot::recording {
namespace {

class RecordingWriterTest : public ::testing::Test {
 protected:
  void SetUp() override { path_ = folder_ + "/run.csv"; }

  static RecordingRow row(int k) {
    RecordingRow r;
    r.time_s = 0.001 * k;
    for (int i = 0; i < 4; ++i) {
      r.reference_m[i] = 0.7 + 1e-6 * k + 0.01 * i;
      r.position_m[i] = r.reference_m[i] - 5e-6;
      r.velocity_m_per_s[i] = 0.001 * i;
      r.command_V[i] = -kDacStep_V * (k % 100);
      r.force_N[i] = 56.8 * r.command_V[i];
    }
    return r;
  }

  /// What close() says when somebody does this to the recording after its first rows.
  std::string saidAfter(const std::function<void()>& interfere) {
    RecordingWriter writer(path_, 4);
    for (int k = 0; k < 100; ++k)
      writer.write(row(k));
    writer.flush();
    interfere();
    for (int k = 100; k < 200; ++k)
      writer.write(row(k));
    try {
      writer.close();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TemporaryFolder folder_;
  std::string path_;
};

TEST_F(RecordingWriterTest, AResidualThatIsNoNumberDoesNotEndTheRecording) {
  RecordingWriter writer(path_, 4);
  for (int k = 0; k < 3; ++k) {
    RecordingRow r = row(k);
    r.residual_known = true;
    r.residual_N = {1.25, std::numeric_limits<double>::infinity(), std::nan(""), 1e300};
    EXPECT_NO_THROW(writer.write(r));
  }
  writer.close();
  EXPECT_NE(readFile(path_).find(",1.2500,"), std::string::npos);
  EXPECT_EQ(loadRecording(path_).rows(), 3);
}

TEST_F(RecordingWriterTest, WhatItWritesIsReadBackUnchanged) {
  RecordingWriter writer(path_, 4);
  const int rows = 5000;  // several buffers full
  for (int k = 0; k < rows; ++k)
    writer.write(row(k));
  writer.close();
  EXPECT_EQ(writer.rows(), 5000u);
  const Recording r = loadRecording(path_);
  ASSERT_EQ(r.rows(), rows);
  EXPECT_EQ(r.axes, 4);
  for (int k = 0; k < rows; k += 7) {
    EXPECT_NEAR(r.time_s[k], row(k).time_s, 1e-9);
    EXPECT_NEAR(r.position_m(k, 3), row(k).position_m[3], 1e-9);
    EXPECT_NEAR(r.velocity_m_per_s(k, 2), 0.002, 1e-9);
    EXPECT_NEAR(r.command_V(k, 1), row(k).command_V[1], 1e-9);
  }
  EXPECT_NO_THROW(commandedForce(r, {56.8, 56.8, 56.8, 56.8}));
}

TEST_F(RecordingWriterTest, AFileThatWasNeverClosedHoldsWholeLinesOnly) {
  RecordingWriter writer(path_, 2);
  for (int k = 0; k < 3000; ++k)
    writer.write(row(k));
  const std::string content = readFile(path_);  // as after a crash: what the buffer still holds is not there
  ASSERT_FALSE(content.empty());
  EXPECT_EQ(content.back(), '\n');
  const Recording r = loadRecording(path_);
  EXPECT_GT(r.rows(), 1000);
  EXPECT_TRUE(r.notes.empty());
}

TEST_F(RecordingWriterTest, ADiskThatFillsUpLeavesWholeLinesAndTheRestIsWrittenWhenThereIsRoomAgain) {
  struct FileSizeLimit {  // stands for the full disk: the file may not grow beyond
    explicit FileSizeLimit(rlim_t bytes) {
      std::signal(SIGXFSZ, SIG_IGN);
      getrlimit(RLIMIT_FSIZE, &before);
      const rlimit small{bytes, before.rlim_max};
      setrlimit(RLIMIT_FSIZE, &small);
    }
    ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before); }
    rlimit before{};
  };
  RecordingWriter writer(path_, 4);
  for (int k = 0; k < 100; ++k)
    writer.write(row(k));
  {
    const FileSizeLimit limit(5011);
    EXPECT_THROW(writer.flush(), InputError);
  }
  const std::string content = readFile(path_);
  EXPECT_GT(content.size(), 4500u);
  EXPECT_LE(content.size(), 5011u);
  EXPECT_EQ(content.back(), '\n');
  EXPECT_GT(loadRecording(path_).rows(), 15);
  writer.close();
  EXPECT_EQ(loadRecording(path_).rows(), 100);
}

TEST_F(RecordingWriterTest, NeverOverwritesARecording) {
  RecordingWriter(path_, 4).close();
  EXPECT_THROW(RecordingWriter(path_, 4), InputError);
  EXPECT_THROW(RecordingWriter(folder_ + "/missing/run.csv", 4), InputError);
  EXPECT_THROW(RecordingWriter(folder_ + "/b.csv", 5), InputError);
}

TEST_F(RecordingWriterTest, SaysThatItsFileWasTakenAwayMeanwhile) {
  namespace fs = std::filesystem;
  EXPECT_EQ(saidAfter([] {}), "");
  fs::remove(path_);
  const std::string removed = saidAfter([&] { fs::remove(path_); });
  EXPECT_EQ(removed.find(path_ + ": was removed while"), 0u) << removed;
  EXPECT_NE(removed.find("record again"), std::string::npos) << removed;
  const std::string replaced = saidAfter([&] { writeFileAtomically(path_, "another one\n"); });
  EXPECT_NE(replaced.find("was replaced by another file"), std::string::npos) << replaced;
  EXPECT_EQ(readFile(path_), "another one\n");
  fs::remove(path_);
  fs::create_directory(folder_ + "/kept");
  const std::string moved = saidAfter([&] { fs::rename(path_, folder_ + "/kept/b.csv"); });
  EXPECT_NE(moved.find("was moved to " + fs::canonical(folder_ + "/kept/b.csv").string()), std::string::npos) << moved;
  EXPECT_EQ(loadRecording(folder_ + "/kept/b.csv").rows(), 200);
}

TEST_F(RecordingWriterTest, SaysThatItsFolderWasRenamedMeanwhile) {
  namespace fs = std::filesystem;
  fs::create_directory(folder_ + "/before");
  path_ = folder_ + "/before/run.csv";
  const std::string said = saidAfter([&] { fs::rename(folder_ + "/before", folder_ + "/after"); });
  EXPECT_NE(said.find("after/run.csv"), std::string::npos) << said;
  EXPECT_EQ(loadRecording(folder_ + "/after/run.csv").rows(), 200);
}

TEST_F(RecordingWriterTest, SaysThatSomebodyElseHasCutItsFileShortOrWrittenIntoIt) {
  const std::string cut = saidAfter([&] { std::filesystem::resize_file(path_, 0); });
  EXPECT_NE(cut.find("changed by somebody else"), std::string::npos) << cut;
  EXPECT_EQ(readFile(path_).find('\0'), std::string::npos) << "what came after it is no heap of zeros";
  std::filesystem::remove(path_);
  const std::string lengthened = saidAfter([&] { std::ofstream(path_, std::ios::app) << "somebody's words\n"; });
  EXPECT_NE(lengthened.find("changed by somebody else"), std::string::npos) << lengthened;
}

TEST_F(RecordingWriterTest, RefusesWhatTheReaderWouldRefuse) {
  RecordingWriter writer(path_, 4);
  writer.write(row(1));
  EXPECT_THROW(writer.write(row(1)), InputError);
  RecordingRow bad = row(2);
  bad.position_m[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(writer.write(bad), InputError);
  writer.write(row(3));
  writer.close();
  EXPECT_THROW(writer.write(row(4)), InputError);
  EXPECT_EQ(loadRecording(path_).rows(), 2);
}

}  // namespace
}  // namespace knee_robot::recording
