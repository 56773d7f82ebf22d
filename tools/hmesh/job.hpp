// tools - one image's way from its file to those of its mesh.
#ifndef HMESH_TOOLS_JOB_HPP
#define HMESH_TOOLS_JOB_HPP

#include <cstdint>
#include <optional>

#include "arguments/arguments.hpp"
#include "thread_pool.hpp"

namespace tool {

enum class JobEnd : std::uint8_t {
    done,
    failed,
    failed_for_all,  // interrupted, or nobody reads what is printed: no other image is to follow
};

// Says how it went: in a summary, or in one line where it is one of several images; what goes wrong in a sentence on the standard
// error. Starts the pool where it is not there yet.
[[nodiscard]] JobEnd run_job(const Arguments& arguments, bool is_one_of_several, std::optional<example::ThreadPool>& pool);

}  // namespace tool

#endif  // HMESH_TOOLS_JOB_HPP
