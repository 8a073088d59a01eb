// A store in a folder of its own, a plan for it, and the message of an error.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "renderer/base/error.h"
#include "tests/support/made_up_store.h"

namespace misbench {

inline std::string message_of(Errc code, const auto& action) {
    try {
        action();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), code) << e.what();
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return e.what();
    }
    ADD_FAILURE() << "no error";
    return "";
}

class StoreTest : public testing::Test {
 protected:
    Store open(Store::Access access = Store::Access::ReadWrite) const { return {folder(), access}; }
    std::filesystem::path folder() const { return temporary_.path() / "store"; }

    const Plan plan_ = made_up_plan("first", 3);
    const Task task_ = made_up_task("plain", 1, SampleBudget{16});

 private:
    TemporaryFolder temporary_;
};

}  // namespace misbench
