#include "proto/codec.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "proto/address.h"
#include "proto/limits.h"
#include "proto/queue.pb.h"
#include "proto/status.h"

namespace misbench {
namespace {

using std::chrono::milliseconds;

const std::string kId(32, 'a');
const std::string kSha(64, 'b');
const LeaseRef kLease{kId, 4};

Task make_task() {
    return {.scene_hash = std::string(64, 'c'),
            .width = 32,
            .height = 16,
            .method = "path",
            .method_version = 3,
            .parameters = {{"max_depth", std::int64_t{5}}, {"mis", std::string("power2")}},
            .budget = TimeBudget{0.25, BudgetClock::Wall},
            .seed = -7,
            .scene = "Box/LightTop",
            .scene_file = "scenes/Box/LightTop.json"};
}

LeaseRef lease_of(const Task& task) { return {.task = task_id(task), .epoch = 12}; }

template <typename Value>
auto there_and_back(const Value& value) {
    return wire::from_wire(wire::to_wire(value));
}

std::string refusal(const std::function<void()>& body) {
    try {
        body();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), Errc::InvalidArgument);
        return error.what();
    }
    return "not refused";
}

TEST(Codec, EveryReportSurvivesTheWire) {
    wire::Call call{.worker = "host:1:2", .build_id = "abc-dirty", .report = {}};
    EXPECT_TRUE(std::holds_alternative<WorkerReport::Idle>(there_and_back(call).report.doing));

    call.report = {.doing = WorkerReport::Working{kLease}, .leaving = true};
    const wire::Call working = there_and_back(call);
    EXPECT_EQ(std::get<WorkerReport::Working>(working.report.doing).lease, kLease);
    EXPECT_TRUE(working.report.leaving);
    EXPECT_EQ(working.worker, "host:1:2");
    EXPECT_EQ(working.build_id, "abc-dirty");

    call.report = {.doing = WorkerReport::Failed{kLease, "no such scene"}, .leaving = false};
    const wire::Call failed = there_and_back(call);
    EXPECT_EQ(std::get<WorkerReport::Failed>(failed.report.doing).lease, kLease);
    EXPECT_EQ(std::get<WorkerReport::Failed>(failed.report.doing).error, "no such scene");
    EXPECT_FALSE(failed.report.leaving);

    call.report = {.doing = WorkerReport::Released{kLease}};
    EXPECT_EQ(std::get<WorkerReport::Released>(there_and_back(call).report.doing).lease, kLease);
}

TEST(Codec, EveryInstructionSurvivesTheWire) {
    const Task task = make_task();
    const LeaseRef lease = lease_of(task);
    const Instruction begin =
        there_and_back(Instruction{Instruction::Begin{lease, task}, milliseconds(5)});
    EXPECT_EQ(std::get<Instruction::Begin>(begin.next).lease, lease);
    EXPECT_EQ(std::get<Instruction::Begin>(begin.next).task, task);
    EXPECT_EQ(begin.call_again_in, milliseconds(5));
    const auto go_on = there_and_back(Instruction{Instruction::GoOn{lease}, {}});
    EXPECT_EQ(std::get<Instruction::GoOn>(go_on.next).lease, lease);
    const auto stop = there_and_back(Instruction{Instruction::Stop{lease}, {}});
    EXPECT_EQ(std::get<Instruction::Stop>(stop.next).lease, lease);
    EXPECT_TRUE(std::holds_alternative<Instruction::Wait>(
        there_and_back(Instruction{Instruction::Wait{}, {}}).next));
    EXPECT_TRUE(std::holds_alternative<Instruction::Exit>(
        there_and_back(Instruction{Instruction::Exit{}, {}}).next));
}

TEST(Codec, ResultsSurviveTheWire) {
    const std::string bytes("a\0b", 3);
    const wire::Chunk chunk = there_and_back(
        wire::Chunk{.lease = kLease, .file = "image.exr", .offset = 9, .data = bytes});
    EXPECT_EQ(chunk.lease, kLease);
    EXPECT_EQ(chunk.file, "image.exr");
    EXPECT_EQ(chunk.offset, 9);
    EXPECT_EQ(chunk.data, bytes);

    const wire::Delivery delivery = there_and_back(wire::Delivery{
        .lease = kLease, .artefacts = {{.file = "record.json", .size = 77, .sha256 = kSha}}});
    EXPECT_EQ(delivery.lease, kLease);
    ASSERT_EQ(delivery.artefacts.size(), 1U);
    EXPECT_EQ(delivery.artefacts[0].file, "record.json");
    EXPECT_EQ(delivery.artefacts[0].size, 77);
    EXPECT_EQ(delivery.artefacts[0].sha256, kSha);

    for (const CommitOutcome outcome :
         {CommitOutcome::Accepted, CommitOutcome::Stale, CommitOutcome::AlreadyDone}) {
        EXPECT_EQ(there_and_back(outcome), outcome);
    }
}

TEST(Codec, PlanAndStatusSurviveTheWire) {
    Plan plan;
    plan.experiment = "first";
    plan.metrics = {"mse"};
    plan.cells = {{.scene = "Box", .method = "pt", .budget = SampleBudget{4}, .task = make_task()}};
    plan.configuration = "{}";
    EXPECT_EQ(there_and_back(plan), plan);

    const SubmitResult submitted = there_and_back(SubmitResult{.tasks = 9, .cached = 2});
    EXPECT_EQ(submitted.tasks, 9);
    EXPECT_EQ(submitted.cached, 2);

    QueueStatus status;
    status.pending = 1;
    status.leased = 2;
    status.done = 3;
    status.failed = 4;
    status.running.push_back({"w", "Box", "pt", kId, 5, milliseconds(60)});
    status.failures.push_back({kId, "Box", "pt", "bad", 8});
    status.finished = {kId, kSha};
    const QueueStatus back = there_and_back(status);
    EXPECT_EQ(back.pending, 1);
    EXPECT_EQ(back.leased, 2);
    EXPECT_EQ(back.done, 3);
    EXPECT_EQ(back.failed, 4);
    ASSERT_EQ(back.running.size(), 1U);
    EXPECT_EQ(back.running[0].worker, "w");
    EXPECT_EQ(back.running[0].scene, "Box");
    EXPECT_EQ(back.running[0].method, "pt");
    EXPECT_EQ(back.running[0].task, kId);
    EXPECT_EQ(back.running[0].seed, 5);
    EXPECT_EQ(back.running[0].since, milliseconds(60));
    ASSERT_EQ(back.failures.size(), 1U);
    EXPECT_EQ(back.failures[0].task, kId);
    EXPECT_EQ(back.failures[0].scene, "Box");
    EXPECT_EQ(back.failures[0].method, "pt");
    EXPECT_EQ(back.failures[0].error, "bad");
    EXPECT_EQ(back.failures[0].seed, 8);
    EXPECT_EQ(back.finished, status.finished);
}

TEST(Codec, LeaseThatCannotBeIsRefused) {
    EXPECT_EQ(refusal([] {
                  there_and_back(LeaseRef{"../../etc", 1});
              }),
              "message refused: malformed task id '../../etc'");
    EXPECT_EQ(refusal([] {
                  there_and_back(LeaseRef{std::string(32, 'A'), 1});
              }),
              "message refused: malformed task id '" + std::string(32, 'A') + "'");
    EXPECT_EQ(refusal([] {
                  there_and_back(LeaseRef{kId, 0});
              }),
              "message refused: epoch 0 of a lease");
}

TEST(Codec, ChunkThatCannotBeIsRefused) {
    const wire::Chunk good{.lease = kLease, .file = "image.exr", .offset = 0, .data = "x"};
    EXPECT_NO_THROW(there_and_back(good));
    wire::Chunk bad = good;
    bad.file = "../image.exr";
    EXPECT_EQ(refusal([&] { there_and_back(bad); }),
              "message refused: unknown artefact '../image.exr'; known: image.exr record.json "
              "snapshot-NUMBER.exr");
    bad.file = "snapshot-000002.exr";
    EXPECT_NO_THROW(there_and_back(bad));
    bad = good;
    bad.data = std::string(kMaxChunkBytes, 'x');
    EXPECT_NO_THROW(there_and_back(bad));
    bad.data += 'x';
    EXPECT_EQ(refusal([&] { there_and_back(bad); }), "message refused: chunk is larger than 1 MiB");
    bad = good;
    bad.offset = -1;
    EXPECT_EQ(refusal([&] { there_and_back(bad); }), "message refused: offset -1 of a chunk");
    bad.offset = kMaxArtefactBytes - 1;
    EXPECT_NO_THROW(there_and_back(bad));
    bad.offset = kMaxArtefactBytes;
    EXPECT_NE(refusal([&] { there_and_back(bad); }), "not refused");
}

TEST(Codec, AnnouncementThatCannotBeIsRefused) {
    const auto announce = [](std::int64_t size, const std::string& sha256) {
        there_and_back(wire::Delivery{.lease = kLease, .artefacts = {{"image.exr", size, sha256}}});
    };
    EXPECT_NO_THROW(announce(0, kSha));
    EXPECT_NE(refusal([&] { announce(-1, kSha); }), "not refused");
    EXPECT_NE(refusal([&] { announce(kMaxArtefactBytes + 1, kSha); }), "not refused");
    EXPECT_NE(refusal([&] { announce(1, "b"); }), "not refused");
}

TEST(Codec, MessageOfAnotherProtocolIsRefused) {
    EXPECT_NE(refusal([] { wire::from_wire(wire::SynchronizeReply()); }), "not refused");
    EXPECT_NE(refusal([] { wire::from_wire(wire::CommitReply()); }), "not refused");
    wire::SynchronizeRequest nothing;
    nothing.set_worker("w");
    EXPECT_NE(refusal([&] { wire::from_wire(nothing); }), "not refused");
    EXPECT_EQ(refusal([] { there_and_back(wire::Call{}); }),
              "message refused: worker without a name");
    wire::SubmitRequest broken;
    broken.set_plan_json("{");
    EXPECT_NE(refusal([&] { wire::from_wire(broken); }), "not refused");
}

TEST(Codec, TaskThatIsNotItsLeasesIsRefused) {
    const Task task = make_task();
    EXPECT_EQ(refusal([&] {
                  there_and_back(Instruction{Instruction::Begin{kLease, task}, {}});
              }),
              "message refused: task whose id is not its lease's");
}

TEST(Codec, LongErrorTextIsCutRatherThanRefused) {
    const wire::Call call{
        .worker = "w",
        .build_id = "b",
        .report = {.doing = WorkerReport::Failed{kLease, std::string(kMaxErrorBytes + 1, 'e')}}};
    EXPECT_EQ(std::get<WorkerReport::Failed>(there_and_back(call).report.doing).error.size(),
              kMaxErrorBytes);
}

TEST(Status, EveryErrorSurvivesTheWire) {
    for (const Errc code : {Errc::InvalidArgument, Errc::NotFound, Errc::FailedPrecondition,
                            Errc::Unavailable, Errc::DataLoss, Errc::Internal}) {
        const Error back = wire::to_error(wire::to_status(Error(code, "what happened")));
        EXPECT_EQ(back.code(), code);
        EXPECT_STREQ(back.what(), "what happened");
    }
}

TEST(Status, SilenceIsUnavailableAndAForeignCodeIsInternal) {
    EXPECT_EQ(wire::to_error({grpc::StatusCode::DEADLINE_EXCEEDED, ""}).code(), Errc::Unavailable);
    EXPECT_EQ(wire::to_error({grpc::StatusCode::UNIMPLEMENTED, ""}).code(), Errc::Internal);
}

TEST(Status, HandlerNeverThrows) {
    EXPECT_TRUE(wire::guarded([] {}).ok());
    const grpc::Status ours = wire::guarded([] { throw Error(Errc::NotFound, "no such run"); });
    EXPECT_EQ(ours.error_code(), grpc::StatusCode::NOT_FOUND);
    EXPECT_EQ(ours.error_message(), "no such run");
    EXPECT_EQ(wire::guarded([] { throw std::runtime_error("surprise"); }).error_code(),
              grpc::StatusCode::INTERNAL);
}

TEST(Address, WhatGrpcWouldMisreadIsRefused) {
    for (const std::string good :
         {"127.0.0.1:0", "localhost:65535", "[::1]:80", "unix:/tmp/x", "node7.cluster:4000"}) {
        EXPECT_NO_THROW(check_address("listen on", good)) << good;
    }
    for (const std::string& bad :
         {std::string(), std::string("nonsense"), std::string("host:"), std::string(":80"),
          std::string("host:65536"), std::string("host:8x"), std::string("host:-1"),
          std::string("unix:"), "unix:/" + std::string(kMaxUnixPathBytes, 'x')}) {
        EXPECT_NE(refusal([&] { check_address("listen on", bad); }), "not refused") << bad;
        EXPECT_NE(refusal([&] { const QueueClient client(bad); }), "not refused") << bad;
    }
    EXPECT_EQ(refusal([] { check_address("listen on", "host:65536"); }),
              "listen on 'host:65536': no address; wanted: unix:/path or host:port");
}

TEST(Address, OnlyThisMachineReachesALocalOne) {
    for (const std::string local :
         {"127.0.0.1:0", "127.9.9.9:1", "localhost:1", "[::1]:1", "unix:/x"}) {
        EXPECT_TRUE(is_local_address(local)) << local;
    }
    for (const std::string remote :
         {"0.0.0.0:0", "[::]:0", "128.0.0.1:1", "127.example.org:1", "node7:1"}) {
        EXPECT_FALSE(is_local_address(remote)) << remote;
    }
}

}  // namespace
}  // namespace misbench
