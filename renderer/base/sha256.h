// SHA-256, the one content address of the project: scenes, tasks, artefacts.
#pragma once

#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace misbench {

class Sha256 {
 public:
    Sha256();
    void update(std::string_view bytes);
    // The digest as 64 lower-case hexadecimal digits. Call once, last.
    std::string hex();

 private:
    struct Release {
        void operator()(evp_md_ctx_st* context) const;
    };
    std::unique_ptr<evp_md_ctx_st, Release> context_;
};

std::string sha256_hex(std::string_view bytes);

}  // namespace misbench
