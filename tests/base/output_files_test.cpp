// SPDX-License-Identifier: GPL-3.0-or-later
// Outputs appear whole or not at all, over nothing that was read, and nothing is left of what was cut short.
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/output_files.h"

namespace meshlode {
namespace {

namespace fs = std::filesystem;

class OutputFilesTest : public testing::Test {
 protected:
  OutputFilesTest() {
    std::string name = (fs::temp_directory_path() / "meshlode-base-XXXXXX").string();
    folder_ = ::mkdtemp(name.data());
  }
  ~OutputFilesTest() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  [[nodiscard]] fs::path path(const std::string& name) const { return folder_ / name; }
  fs::path put(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }
  [[nodiscard]] static std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : fs::directory_iterator(folder_)) out.push_back(entry.path().filename().string());
    std::sort(out.begin(), out.end());
    return out;
  }
  static std::vector<std::uint8_t> bytes(const std::string& text) { return {text.begin(), text.end()}; }
  /// Runs `body` in a process of its own and returns how that ended (waitpid's status).
  template <class Body>
  static int in_child(const Body& body) {
    const pid_t child = ::fork();
    if (child == 0) {
      body();
      ::_exit(0);
    }
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return status;
  }

  fs::path folder_;
};

TEST_F(OutputFilesTest, AFileThatWasReadIsKeptUnderEveryName) {
  const fs::path input = put("input", "precious");
  fs::create_symlink("input", path("link"));
  fs::create_symlink("link", path("link to link"));
  fs::create_hard_link(input, path("hard"));
  fs::create_directory(path("sub"));
  fs::create_directory_symlink(folder_, path("door"));
  const auto file = MappedFile::open(input);
  ASSERT_TRUE(file);
  OutputFiles files;
  files.keep(file->id());
  for (const std::string name : {"input", "./input", "sub/../input", "link", "link to link", "hard", "door/input"}) {
    const Status claimed = files.claim(path(name)), written = files.write(path(name), bytes("gone"));
    ASSERT_FALSE(claimed) << name;
    ASSERT_FALSE(written) << name;
    EXPECT_EQ(claimed.error().code, ErrorCode::kUsage);
    EXPECT_EQ(written.error().code, ErrorCode::kUsage);
    EXPECT_EQ(written.error().where, path(name).string());
  }
  EXPECT_EQ(text_of(input), "precious");
  EXPECT_EQ(names(), (std::vector<std::string>{"door", "hard", "input", "link", "link to link", "sub"}));
  EXPECT_TRUE(files.write(path("output"), bytes("new")));
  EXPECT_EQ(text_of(path("output")), "new");
}

TEST_F(OutputFilesTest, ASecondOutputIsNotWrittenOverTheFirst) {
  put("old", "old");
  OutputFiles files;
  EXPECT_TRUE(files.write(path("old"), bytes("first"))) << "what was neither read nor written here may be replaced";
  const Status second = files.write(path("old"), bytes("second"));
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kUsage);
  EXPECT_EQ(text_of(path("old")), "first");
  EXPECT_TRUE(OutputFiles().write(path("old"), bytes("another command's")));
  fs::create_symlink("new", path("link"));
  EXPECT_TRUE(is_same_place(path("new"), path("./new")));
  EXPECT_TRUE(is_same_place(path("new"), path("link")));
  EXPECT_TRUE(is_same_place(path("old"), path("old")));
  EXPECT_FALSE(is_same_place(path("old"), path("new")));
  EXPECT_FALSE(is_same_place(path("new"), path("newer")));
}

TEST_F(OutputFilesTest, LinksAreFollowedAndDevicesWrittenTo) {
  fs::create_directory(path("elsewhere"));
  fs::create_symlink("elsewhere/file", path("link"));
  EXPECT_TRUE(OutputFiles().write(path("link"), bytes("one")));
  EXPECT_TRUE(OutputFiles().write(path("link"), bytes("two")));
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(text_of(path("elsewhere/file")), "two");
  EXPECT_TRUE(OutputFiles().write("/dev/null", bytes("nothing")));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const Status full = OutputFiles().write("/dev/full", bytes("more than fits"));
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kIo);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(OutputFilesTest, WhatCannotBeWrittenIsSaidBeforeTheWork) {
  fs::create_directory(path("folder"));
  put("file", "x");
  for (const std::string name : {"folder", "missing/file", "file/below"}) {
    const Status claimed = OutputFiles().claim(path(name));
    ASSERT_FALSE(claimed) << name;
    EXPECT_EQ(claimed.error().code, ErrorCode::kIo);
    EXPECT_FALSE(OutputFiles().write(path(name), bytes("x")));
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"file", "folder"}));
  if (::geteuid() == 0) return;  // root may write everywhere
  fs::permissions(path("folder"), fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_FALSE(OutputFiles().claim(path("folder/file")));
}

TEST_F(OutputFilesTest, FoldersAreMadeWhereAskedForAndNotBeforeTheWrite) {
  put("file", "x");
  OutputFiles files(OutputFiles::Folders::kAreMade);
  EXPECT_TRUE(files.claim(path("some/folder/out")));
  EXPECT_EQ(names(), std::vector<std::string>{"file"});
  EXPECT_TRUE(files.write(path("some/folder/out"), bytes("new")));
  EXPECT_EQ(text_of(path("some/folder/out")), "new");
  const Status below = files.claim(path("file/folder/out"));
  ASSERT_FALSE(below);
  EXPECT_EQ(below.error().code, ErrorCode::kIo);
}

TEST_F(OutputFilesTest, AFileMayBeRewrittenUntilItIsWritten) {
  OutputFiles files;
  for (const char* text : {"one", "two"}) {
    EXPECT_TRUE(files.claim(path("told")));
    EXPECT_TRUE(files.rewrite(path("told"), bytes(text)));
    EXPECT_EQ(text_of(path("told")), text);
  }
  EXPECT_TRUE(files.write(path("told"), bytes("three")));
  EXPECT_FALSE(files.rewrite(path("told"), bytes("four")));
  EXPECT_EQ(names(), std::vector<std::string>{"told"});
  const fs::path read = put("read", "x");
  files.keep(*find_file_id(read));
  EXPECT_FALSE(files.rewrite(read, bytes("y")));
}

TEST_F(OutputFilesTest, NewFilesHaveTheModeThatTheProcessGivesThem) {
  const mode_t before = ::umask(027);
  EXPECT_TRUE(OutputFiles().write(path("file"), bytes("x")));
  EXPECT_EQ(::umask(before), mode_t{027}) << "the mask was left alone";
  struct stat info {};
  ASSERT_EQ(::stat(path("file").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0640U);
}

/// A size limit that kills: the process ends in the middle of a write, with as little warning as by SIGKILL.
TEST_F(OutputFilesTest, WhatAKilledWriterLeavesTheNextOneRemoves) {
  const std::vector<std::uint8_t> large(1 << 20U, 7);
  const int status = in_child([&] {
    const rlimit limit{4096, 4096};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    std::signal(SIGXFSZ, SIG_DFL);
    static_cast<void>(OutputFiles().write(path("asset"), large));
  });
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGXFSZ);
  ASSERT_EQ(names().size(), 1U);
  EXPECT_TRUE(names()[0].starts_with(".meshlode-") && names()[0].ends_with(".tmp")) << names()[0];
  put(".meshlode-notes.tmp", "not one of these");
  put(".meshlode-0123456789ABCDEF.tmp", "nor this");
  const fs::path living = put(".meshlode-0123456789abcdef.tmp", "being written");
  const int lock = ::open(living.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(::flock(lock, LOCK_EX), 0);
  EXPECT_TRUE(OutputFiles().claim(path("asset"))) << "also where nothing is written in the end";
  EXPECT_EQ(names(), (std::vector<std::string>{".meshlode-0123456789ABCDEF.tmp", ".meshlode-0123456789abcdef.tmp",
                                               ".meshlode-notes.tmp"}));
  ::close(lock);
  EXPECT_TRUE(OutputFiles().write(path("asset"), bytes("whole")));
  EXPECT_EQ(names(), (std::vector<std::string>{".meshlode-0123456789ABCDEF.tmp", ".meshlode-notes.tmp", "asset"}));
}

TEST_F(OutputFilesTest, AWriteThatFailsLeavesNothingAndTheOldFile) {
  put("asset", "old");
  const std::vector<std::uint8_t> large(1 << 20U, 7);
  const int status = in_child([&] {
    const rlimit limit{4096, 4096};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::signal(SIGXFSZ, SIG_IGN);
    const Status written = OutputFiles().write(path("asset"), large);
    ::_exit(!written && written.error().code == ErrorCode::kIo ? 0 : 1);
  });
  EXPECT_EQ(status, 0);
  EXPECT_EQ(names(), (std::vector<std::string>{"asset"}));
  EXPECT_EQ(text_of(path("asset")), "old");
}

/// Whenever the abandonment comes, before, during or after the write: the file is whole or not there, and nothing else.
TEST_F(OutputFilesTest, AnAbandonedWriteLeavesNothing) {
  const std::vector<std::uint8_t> large(8 << 20U, 7);
  for (int microseconds = 0; microseconds < 20000; microseconds += 1000) {
    OutputFiles files;
    Status written = Ok{};
    std::thread writer([&] { written = files.write(path("asset"), large); });
    std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
    files.abandon();
    const std::vector<std::string> left = names();  // as the process would leave it, ending here
    EXPECT_EQ(files.has_written(path("asset")), !left.empty());
    writer.join();
    if (!left.empty()) {
      EXPECT_EQ(left, (std::vector<std::string>{"asset"}));
      EXPECT_TRUE(written);
      EXPECT_EQ(fs::file_size(path("asset")), large.size());
      fs::remove(path("asset"));
    } else {
      EXPECT_FALSE(written);
    }
    EXPECT_TRUE(names().empty());
    EXPECT_FALSE(files.write(path("later"), bytes("x")));
  }
}

/// Many writers and sweepers of one folder take nothing from each other.
TEST_F(OutputFilesTest, WritersAtOnceDoNotSweepEachOther) {
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < 25; ++i) {
        const Status written = OutputFiles().write(path(std::to_string(t) + "-" + std::to_string(i)), bytes("whole"));
        EXPECT_TRUE(written) << (written ? "" : written.error().message());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(names().size(), 200U);
}

}  // namespace
}  // namespace meshlode
