// What is kept on the disk and comes back; what is wrong there stops nobody and is reported.
#include "service/client/model_cache.hpp"

#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "identification/correction/integral_feedback_search.hpp"
#include "service/client/cached_version_file.hpp"
#include "service/support/sha256.hpp"
#include "tests/service/dds/dds_fixture.hpp"
#include "tests/service/model/example_model.hpp"
#include "tests/support/every_field.hpp"

namespace reident::test::model_cache_test {
namespace {

namespace fs = std::filesystem;

CachedVersion kept(std::int64_t number, const std::string& spacecraft = "CBERS4",
                   const std::string& equipment = "BDR") {
  CachedVersion one{example_version(number), 100, 200};
  one.version.model.spacecraft = spacecraft;
  one.version.model.equipment = equipment;
  one.version.digest = model_digest(one.version.model);
  return one;
}

class Cache : public testing::Test {
 protected:
  Cache() { fs::remove_all(folder_); }
  ~Cache() override {
    chmod_folder(0700);
    fs::remove_all(folder_);
  }

  ModelCache cache(const std::string& partition = "operations") const {
    return {folder_, partition};
  }
  void store(const CachedVersion& one) {
    cache_.store(one, [this](const CacheFault& fault) { faults_.push_back(fault.reason); });
  }
  std::vector<CachedVersion> load() {
    return cache().load([this](const CacheFault& fault) { faults_.push_back(fault.reason); });
  }
  std::int64_t loaded() {
    const auto versions = load();
    return versions.empty() ? 0 : versions[0].version.number;
  }
  fs::path file() const { return cache_.file_of({"CBERS4", "BDR"}); }
  std::string text() const {
    std::ifstream stream(file(), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void write(const std::string& content) const {
    std::ofstream(file(), std::ios::binary | std::ios::trunc) << content;
  }
  void chmod_folder(mode_t mode) const { ::chmod(file().parent_path().c_str(), mode); }

  const fs::path folder_ = fs::temp_directory_path() / ("cache-test-" + std::to_string(getpid()));
  ModelCache cache_{folder_, "operations"};
  std::vector<std::string> faults_;
};

TEST_F(Cache, GivesBackTheSameBitsAndAllThatGoesWithThem) {
  CachedVersion one = kept(3);
  one.version.model = full_example_model();
  const identification::Poles poles = {0.5, 0.6, 0.7, 0.8};
  one.version.model.tracking->gain =
      std::get<identification::TrackingPlacement>(
          identification::place_tracking_poles(one.version.model.dynamics, poles,
                                               identification::Vector::Constant(1, 10)))
          .gain;
  one.version.digest = model_digest(one.version.model);
  one.version.rollback = true;
  store(one);
  const auto versions = load();
  ASSERT_EQ(versions.size(), 1U);
  EXPECT_THAT(differing_fields(versions[0].version, one.version), testing::IsEmpty());
  EXPECT_EQ(versions[0].published, 100);
  EXPECT_EQ(versions[0].received, 200);
  EXPECT_THAT(faults_, testing::IsEmpty());
}

// Simulators hold such files: the text stays as it is, to the last byte.
TEST_F(Cache, WritesTheTextThatItAlwaysWrote) {
  CachedVersion one = kept(3);
  one.version.rollback = true;
  const std::string kept_text =
      R"({"partition":"operations","number":3,)"
      R"("digest":"17910f60ef1713b1804a8bb1ac83963863c0cef758d0f6d27535e0d025323a45",)"
      R"("decided_ns":42,"decided_by":"gate","rollback":true,"program_version":"0.1.0",)"
      R"("published_ns":100,"received_ns":200,"model":)" +
      to_json(example_model()).dump() + "}";
  EXPECT_EQ(
      kept_version_text(one, "operations"),
      R"({"format":1,"sha256":")" + sha256_hex(kept_text) + R"(","kept":)" + kept_text + "}\n");
}

TEST_F(Cache, IsEmptyBeforeTheFirstVersionAndMakesNoFolderForThat) {
  EXPECT_EQ(loaded(), 0);
  EXPECT_FALSE(fs::exists(folder_));
  EXPECT_THAT(faults_, testing::IsEmpty());
}

TEST_F(Cache, KeepsEveryLegalNameApartAndInsideTheFolder) {
  std::string accents;
  for (int i = 0; i < 85; ++i) accents += "\xe2\x82\xac";  // 255 bytes
  const std::vector<storage::EquipmentName> names = {
      {"..", "BDR"},   {".", ".."},     {"a/../../b", "c"}, {"a", "b,c"},
      {"a,b", "c"},    {"CON%2F", "x"}, {"CON/", "x"},      {accents, accents},
      {accents, "e1"}, {"*", "?"},      {"a b", "~"},       {std::string(255, '/'), accents},
      {"A", "x"},      {"a", "x.json"}};
  for (const auto& [spacecraft, equipment] : names) store(kept(1, spacecraft, equipment));
  EXPECT_THAT(faults_, testing::IsEmpty());
  std::vector<storage::EquipmentName> back;
  for (const CachedVersion& one : load())
    back.push_back({one.version.model.spacecraft, one.version.model.equipment});
  EXPECT_THAT(back, testing::UnorderedElementsAreArray(names));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(Cache, KeepsPartitionsApart) {
  store(kept(1));
  for (const char* other : {"training", "../operations", "", "operations/"})
    EXPECT_TRUE(cache(other).load([](const CacheFault&) {}).empty()) << other;
}

TEST_F(Cache, ReplacesAnOlderVersionAndKeepsANewerOne) {
  store(kept(5));
  store(kept(4));
  EXPECT_EQ(loaded(), 5);
  CachedVersion back = kept(4);
  back.version.rollback = true;
  store(back);
  EXPECT_EQ(loaded(), 4);
  store(kept(6));
  EXPECT_EQ(loaded(), 6);
  EXPECT_THAT(faults_, testing::IsEmpty());
}

TEST_F(Cache, DoesNotWriteWhatIsThereAlready) {
  store(kept(5));
  const auto before = fs::last_write_time(file());
  struct stat first {
  }, second{};
  ASSERT_EQ(::stat(file().c_str(), &first), 0);
  store(kept(5));
  ASSERT_EQ(::stat(file().c_str(), &second), 0);
  EXPECT_EQ(first.st_ino, second.st_ino);
  EXPECT_EQ(fs::last_write_time(file()), before);
}

TEST_F(Cache, SetsAsideAFileThatIsDamagedAndStartsWithoutIt) {
  store(kept(5));
  const std::string good = text();
  std::string flipped = good;
  flipped[flipped.find("\"number\":5") + 9] = '7';
  CachedVersion unstable = kept(5);
  unstable.version.model.dynamics.A(0, 0) = 1.5;
  unstable.version.digest = model_digest(unstable.version.model);
  struct Damage {
    std::string content, says;
  };
  for (const auto& [content, says] :
       {Damage{good.substr(0, good.size() / 2), "truncated"}, Damage{"", "truncated"},
        Damage{"[1, 2]", "JSON"}, Damage{"{}", "format"}, Damage{std::string(5000, '['), "JSON"},
        Damage{R"({"format": 1, "sha256": "", "kept": )" + std::string(1'000'000, '[') +
                   std::string(1'000'000, ']') + "}",
               "SHA-256"},
        Damage{flipped, "SHA-256"},
        Damage{kept_version_text(kept(5), "training"), "another partition"},
        Damage{kept_version_text(kept(5, "CBERS4", "MEA"), "operations"), "CBERS4/MEA"},
        Damage{kept_version_text(kept(0), "operations"), "number"},
        Damage{kept_version_text(unstable, "operations"), "spectral radius"}}) {
    faults_.clear();
    write(content);
    EXPECT_EQ(loaded(), 0) << says;
    ASSERT_EQ(faults_.size(), 1U) << says;
    EXPECT_THAT(faults_[0], testing::AllOf(testing::HasSubstr(says),
                                           testing::HasSubstr("set aside as .damaged")));
    EXPECT_FALSE(fs::exists(file()));
    EXPECT_TRUE(fs::exists(file().string() + ".damaged"));
  }
  store(kept(6));
  EXPECT_EQ(loaded(), 6);
}

TEST_F(Cache, LeavesWhatANewerProgramWroteAndSaysSo) {
  store(kept(5));
  const std::string newer = R"({"format": 2, "kept": "otherwise"})";
  write(newer);
  EXPECT_EQ(loaded(), 0);
  store(kept(6));
  EXPECT_EQ(text(), newer);
  ASSERT_EQ(faults_.size(), 2U);
  EXPECT_THAT(faults_[0], testing::HasSubstr("its format is 2"));
  EXPECT_THAT(faults_[1], testing::HasSubstr("is not replaced"));
}

TEST_F(Cache, PassesOverWhatIsNotAFileOfAVersion) {
  store(kept(5));
  std::ofstream(file().parent_path() / "README") << "hello";
  std::ofstream(file().string() + ".part") << "half";
  fs::create_directory(file().parent_path() / "folder.json");
  ASSERT_EQ(::mkfifo((file().parent_path() / "pipe.json").c_str(), 0600), 0);
  EXPECT_EQ(loaded(), 5);
  EXPECT_THAT(faults_, testing::ElementsAre(testing::HasSubstr("folder.json is not used"),
                                            testing::HasSubstr("pipe.json is not used")));
}

TEST_F(Cache, SaysOnceThatItCannotWriteAndAgainWhenThatChanges) {
  std::ofstream{folder_} << "a file where the folder should be";
  store(kept(1));
  store(kept(2));
  ASSERT_EQ(faults_.size(), 1U);
  EXPECT_THAT(faults_[0], testing::HasSubstr("cannot be made"));
  EXPECT_EQ(loaded(), 0);
  fs::remove(folder_);
  store(kept(3));
  EXPECT_EQ(loaded(), 3);
  EXPECT_EQ(faults_.size(), 1U);
  fs::remove_all(folder_);
  std::ofstream{folder_} << "and again";
  store(kept(4));
  EXPECT_EQ(faults_.size(), 2U) << "it had been mended";
}

TEST_F(Cache, OfAReadOnlyFolderIsReadAndReportsWhatItCannotWrite) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  store(kept(5));
  chmod_folder(0500);
  EXPECT_EQ(loaded(), 5);
  store(kept(6));
  ASSERT_EQ(faults_.size(), 1U);
  EXPECT_THAT(faults_[0], testing::HasSubstr("ermission"));
}

TEST_F(Cache, DoesNotWaitForEverForAProgramThatHoldsTheFolder) {
  store(kept(5));
  const int other = ::open(file().parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  store(kept(6));
  ASSERT_EQ(faults_.size(), 1U);
  EXPECT_THAT(faults_[0], testing::HasSubstr("locked by another program"));
  EXPECT_EQ(loaded(), 5) << "reading needs no lock";
  ::close(other);
}

TEST_F(Cache, ThatSimulatorsShareEndsWithTheNewestVersionWhole) {
  constexpr std::int64_t last = 60;
  std::vector<std::thread> simulators;
  for (int s = 0; s < 3; ++s) {
    simulators.emplace_back([this, s] {
      ModelCache own = cache();
      for (std::int64_t number = 1 + s; number <= last; number += 3)
        own.store(kept(number), [](const CacheFault& fault) { ADD_FAILURE() << fault.reason; });
    });
  }
  for (std::thread& simulator : simulators) simulator.join();
  EXPECT_EQ(loaded(), last);
  EXPECT_THAT(faults_, testing::IsEmpty());
  EXPECT_EQ(std::distance(fs::directory_iterator(file().parent_path()), {}), 1);
}

TEST_F(Cache, IsWholeAfterAKillAtAnyMoment) {
  store(kept(1));
  std::int64_t last = 1;
  for (int round = 0; round < 10; ++round) {
    const pid_t writer = ::fork();
    ASSERT_GE(writer, 0);
    for (std::int64_t number = last + 1; writer == 0; ++number)
      cache_.store(kept(number), [](const CacheFault&) {});
    const bool has_begun = eventually([&] {  // without the lock, which the writer needs
      const auto there = read_kept_version(file(), "operations");
      return std::get<CachedVersion>(there).version.number > last + round;
    });
    ::kill(writer, SIGKILL);
    ::waitpid(writer, nullptr, 0);
    ASSERT_TRUE(has_begun);
    const std::int64_t now = loaded();
    EXPECT_GT(now, last);
    last = now;
  }
  EXPECT_THAT(faults_, testing::IsEmpty());
  store(kept(last + 1));
  EXPECT_EQ(loaded(), last + 1) << "what the dead left behind is in nobody's way";
}

TEST(CacheFolder, IsThatOfTheUser) {
  setenv("XDG_CACHE_HOME", "/x/cache", 1);
  EXPECT_EQ(ModelCache::default_folder(), fs::path("/x/cache/reident"));
  setenv("XDG_CACHE_HOME", "relative", 1);
  setenv("HOME", "/home/operator", 1);
  EXPECT_EQ(ModelCache::default_folder(), fs::path("/home/operator/.cache/reident"));
  unsetenv("XDG_CACHE_HOME");
  unsetenv("HOME");
  EXPECT_EQ(ModelCache::default_folder(), std::nullopt);
}

}  // namespace
}  // namespace reident::test::model_cache_test
