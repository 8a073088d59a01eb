// What the disk and other processes do to a store: read-only folders, full disks, crashes, a second
// writer. Each runs in a process of its own, because that is where the trouble comes from.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "renderer/base/error.h"
#include "tests/support/made_up_store.h"

namespace misbench {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A process that is forked now, acts when told to, and ends without any destructor, as a crash
// does. It must be forked before this process opens a database: SQLite's own state does not survive
// a fork.
class Child {
 public:
    explicit Child(const auto& action) {
        if (::pipe(go_.data()) != 0 || ::pipe(said_.data()) != 0) throw std::runtime_error("pipe");
        pid_ = ::fork();
        if (pid_ != 0) {
            ::close(said_[1]);  // or the next child would keep it open
            return;
        }
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        char signal = 0;
        std::ignore = ::read(go_[0], &signal, 1);
        const std::string said = text_of(action);
        std::ignore = ::write(said_[1], said.data(), said.size());
        ::_exit(0);
    }

    ~Child() {
        for (const int descriptor : {go_[0], go_[1], said_[0]}) ::close(descriptor);
        if (waited_) return;
        ::kill(pid_, SIGKILL);
        ::waitpid(pid_, nullptr, 0);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    // What the action returned; the text of an Error starts with its code's number.
    std::string act() {
        std::ignore = ::write(go_[1], "!", 1);
        std::string said;
        std::array<char, 4096> buffer{};
        for (ssize_t n = 0; (n = ::read(said_[0], buffer.data(), buffer.size())) > 0;) {
            said.append(buffer.data(), static_cast<std::size_t>(n));
        }
        int status = 0;
        ::waitpid(pid_, &status, 0);
        waited_ = true;
        EXPECT_EQ(status, 0);
        return said;
    }

 private:
    static std::string text_of(const auto& action) {
        try {
            return action();
        } catch (const Error& e) {
            return std::to_string(static_cast<int>(e.code())).append(" ").append(e.what());
        } catch (const std::exception& e) {
            return std::string("not an Error: ").append(e.what());
        }
    }

    std::array<int, 2> go_{};
    std::array<int, 2> said_{};
    pid_t pid_ = 0;
    bool waited_ = false;
};

std::string in_child(const auto& action) { return Child(action).act(); }

std::string code(Errc errc) { return std::to_string(static_cast<int>(errc)) + " "; }

// Permissions do not bind root.
void become_nobody() {
    if (::geteuid() != 0) return;
    constexpr unsigned kNobody = 65534;
    if (::setgroups(0, nullptr) != 0 || ::setgid(kNobody) != 0 || ::setuid(kNobody) != 0) {
        throw std::runtime_error("become nobody");
    }
}

class StoreDiskTest : public testing::Test {
 protected:
    StoreDiskTest() { fs::permissions(temporary_.path(), fs::perms{0755}); }
    ~StoreDiskTest() override { set_writable(true); }

    fs::path folder() const { return temporary_.path() / "store"; }

    void set_writable(bool writable) const {
        if (!fs::exists(folder())) return;
        fs::permissions(folder(), fs::perms{writable ? 0755U : 0555U});
        for (const auto& entry : fs::recursive_directory_iterator(folder())) {
            const bool is_folder = entry.is_directory();
            fs::permissions(entry.path(), fs::perms{writable ? (is_folder ? 0755U : 0644U)
                                                             : (is_folder ? 0555U : 0444U)});
        }
    }

    // Everything that a table needs.
    std::string read_all() const {
        const Store store(folder(), Store::Access::ReadOnly);
        const Plan plan = store.experiment("");
        return plan.experiment + " tasks " + std::to_string(store.tasks().size()) + " runs " +
               std::to_string(store.run_summaries().size()) + " measurements " +
               std::to_string(store.measurements(plan).size());
    }

    void fill(Store& store) const {
        store.put_experiment(plan_);
        commit_all(store, plan_);
        store.measure(plan_);
    }

    const Plan plan_ = made_up_plan("first", 3);
    const std::string whole_ = "first tasks 8 runs 8 measurements 12";

 private:
    TemporaryFolder temporary_;
};

TEST_F(StoreDiskTest, ReadingChangesNoByte) {
    {
        Store store(folder(), Store::Access::ReadWrite);
        fill(store);
    }
    const auto before = hashes_below(folder());
    EXPECT_EQ(in_child([&] { return read_all(); }), whole_);
    EXPECT_EQ(hashes_below(folder()), before);
}

TEST_F(StoreDiskTest, StoreWithoutAWriterIsOneDatabaseFile) {
    { const Store store(folder(), Store::Access::ReadWrite); }
    EXPECT_FALSE(fs::exists(folder() / "results.sqlite-wal"));
    EXPECT_FALSE(fs::exists(folder() / "results.sqlite-shm"));
}

TEST_F(StoreDiskTest, ReadingBesideAWriterChangesNoByteAndSeesTheLatest) {
    Child first([&] { return read_all(); });
    Child second([&] { return read_all(); });
    Store store(folder(), Store::Access::ReadWrite);
    fill(store);
    const auto before = hashes_below(folder());
    EXPECT_TRUE(before.contains("results.sqlite-wal"));
    EXPECT_EQ(first.act(), whole_);
    EXPECT_EQ(hashes_below(folder()), before);
    commit_made_up_run(store, made_up_task("plain", 99, SampleBudget{16}));
    EXPECT_EQ(second.act(), "first tasks 8 runs 9 measurements 12");
}

TEST_F(StoreDiskTest, WriterComesAndGoesWhileAReaderIsThere) {
    {
        Store store(folder(), Store::Access::ReadWrite);
        fill(store);
    }
    const Task more = made_up_task("plain", 99, SampleBudget{16});
    Child writer([&] {
        Store store(folder(), Store::Access::ReadWrite);
        commit_made_up_run(store, more);
        return std::string("written");
    });
    Child next_writer([&] {
        return std::to_string(Store(folder(), Store::Access::ReadWrite).has_run(task_id(more)) ? 1
                                                                                               : 0);
    });
    {
        const Store reader(folder(), Store::Access::ReadOnly);
        EXPECT_FALSE(reader.has_run(task_id(more)));
        EXPECT_EQ(writer.act(), "written");
        EXPECT_TRUE(reader.has_run(task_id(more)));
        EXPECT_EQ(next_writer.act(), "1");
        EXPECT_TRUE(reader.has_run(task_id(more)));
    }
}

TEST_F(StoreDiskTest, ReadOnlyFolderCanBeReadAndSaysSoToAWriter) {
    {
        Store store(folder(), Store::Access::ReadWrite);
        fill(store);
    }
    set_writable(false);
    EXPECT_EQ(in_child([&] {
                  become_nobody();
                  return read_all();
              }),
              whole_);
    const std::string said = in_child([&] {
        become_nobody();
        const Store store(folder(), Store::Access::ReadWrite);
        return std::string("opened");
    });
    EXPECT_THAT(said, testing::AllOf(testing::StartsWith(code(Errc::FailedPrecondition)),
                                     HasSubstr("Permission denied")));
}

TEST_F(StoreDiskTest, StoreOfACrashedWriterCanBeReadFromAReadOnlyFolder) {
    EXPECT_EQ(in_child([&] {
                  static Store store(folder(), Store::Access::ReadWrite);
                  fill(store);
                  return std::string("filled");
              }),
              "filled");
    ASSERT_TRUE(fs::exists(folder() / "results.sqlite-wal"));
    set_writable(false);
    const auto before = hashes_below(folder());
    EXPECT_EQ(in_child([&] {
                  become_nobody();
                  return read_all();
              }),
              whole_);
    EXPECT_EQ(hashes_below(folder()), before);
}

TEST_F(StoreDiskTest, EpochOfACrashedWriterIsNeverGrantedAgain) {
    const std::string granted = in_child([&] {
        static Store store(folder(), Store::Access::ReadWrite);
        store.next_epoch();
        return std::to_string(store.next_epoch());
    });
    Store store(folder(), Store::Access::ReadWrite);
    EXPECT_EQ(store.next_epoch(), std::stoll(granted) + 1);
}

TEST_F(StoreDiskTest, SecondWriterIsRefusedWithTheProcessOfTheFirst) {
    {
        const Store store(folder(), Store::Access::ReadWrite);
        const std::string said = in_child([&] {
            const Store second(folder(), Store::Access::ReadWrite);
            return std::string("opened");
        });
        EXPECT_EQ(said, code(Errc::FailedPrecondition) + "store '" + folder().string() +
                            "' is in use by process " + std::to_string(::getpid()));
        EXPECT_THAT(in_child([&] {
                        reindex(folder());
                        return std::string("reindexed");
                    }),
                    HasSubstr("is in use by process " + std::to_string(::getpid())));
    }
    EXPECT_NO_THROW(Store(folder(), Store::Access::ReadWrite));
}

TEST_F(StoreDiskTest, FolderWithoutAStoreIsNotFoundAndStaysEmpty) {
    fs::create_directories(folder());
    EXPECT_THAT(in_child([&] { return read_all(); }),
                testing::StartsWith(code(Errc::NotFound) + "open store '" + folder().string()));
    EXPECT_TRUE(fs::is_empty(folder()));
}

// --- full disk ---------------------------------------------------------------------------------

// Commits runs while less and less can be written. Every step works or is a DataLoss, and what was
// reported as kept is there, whole, once there is room again. `squeeze(i)` leaves room for about i
// KiB, `relax` ends it.
std::string work_on_a_full_disk(const fs::path& folder, const auto& squeeze, const auto& relax) {
    std::vector<Task> kept;
    std::int64_t epoch = 0;
    int n_errors = 0;
    for (std::int64_t kib = 0; kib < 400; kib += 16) {
        const Task task = made_up_task("plain", kib, SampleBudget{16});
        Store store(folder, Store::Access::ReadWrite);
        const fs::path staged = stage_made_up_run(store, task);
        squeeze(kib);
        try {
            epoch = store.next_epoch();
            if (store.commit_run(staged) == Recorded::New) kept.push_back(task);
            store.put_experiment(made_up_plan("number" + std::to_string(kib), 3));
        } catch (const Error& e) {
            ++n_errors;
            if (e.code() != Errc::DataLoss) return std::string("other error: ") + e.what();
            if (std::string(e.what()).find(folder.string()) == std::string::npos) {
                return std::string("does not name a path: ") + e.what();
            }
        }
        relax();
    }
    Store store(folder, Store::Access::ReadWrite);
    if (store.next_epoch() <= epoch) return "an epoch came again";
    for (const Task& task : kept) {
        if (store.run_image(task_id(task)) != made_up_image(task)) return "an image is lost";
        if (!store.has_run(task_id(task))) return "a row is lost";
    }
    if (store.experiments().empty()) return "no experiment was kept";
    if (fs::exists(folder / "damaged")) return "something was damaged";
    return n_errors > 0 && !kept.empty() ? "nothing lost" : "the disk was never full";
}

TEST_F(StoreDiskTest, FullDiskLosesNothing) {
    // A small tmpfs in a mount namespace of the child's.
    const auto mount_tmpfs = [&] {
        fs::create_directories(folder());
        if (::unshare(CLONE_NEWNS) != 0 && ::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) {
            return false;
        }
        return ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
               ::mount("tmpfs", folder().c_str(), "tmpfs", 0, "size=8m") == 0;
    };
    const std::string said = in_child([&] {
        if (!mount_tmpfs()) return std::string("no tmpfs");
        const fs::path ballast = folder() / "ballast";
        return work_on_a_full_disk(
            folder() / "store",
            [&](std::int64_t kib) {
                const auto free = static_cast<std::int64_t>(fs::space(folder()).available);
                const int file = ::open(ballast.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0644);
                std::ignore =
                    ::posix_fallocate(file, 0, std::max<std::int64_t>(free - kib * 1024, 1));
                ::close(file);
            },
            [&] { fs::remove(ballast); });
    });
    if (said == "no tmpfs") GTEST_SKIP() << "mounting is not permitted";
    EXPECT_EQ(said, "nothing lost");
}

// The same where mounting is not permitted: the size of a file is limited instead.
TEST_F(StoreDiskTest, FileThatMayNotGrowLosesNothing) {
    const std::string said = in_child([&] {
        std::signal(SIGXFSZ, SIG_IGN);
        const auto limit = [](rlim_t bytes) {
            const rlimit wanted{.rlim_cur = bytes, .rlim_max = RLIM_INFINITY};
            if (::setrlimit(RLIMIT_FSIZE, &wanted) != 0) throw std::runtime_error("setrlimit");
        };
        return work_on_a_full_disk(
            folder(), [&](std::int64_t kib) { limit(static_cast<rlim_t>(kib) * 1024); },
            [&] { limit(RLIM_INFINITY); });
    });
    EXPECT_EQ(said, "nothing lost");
}

}  // namespace
}  // namespace misbench
