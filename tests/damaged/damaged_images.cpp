// hmesh tests - damages image files in many ways and reads them: each has to be read twice as the same picture, or refused twice
// in the same words, whatever the memory held before.
//
// usage: damaged_images COUNT FOLDER [FINDINGS [FIRST]]
//        FOLDER: of whole image files, which scripts/damage.sh makes; COUNT: how many damaged ones; a file that is read in two
//        ways, ends the program or takes more than ten seconds is kept in FINDINGS. Number FIRST + k is the same in each run.
// Prints a line for each kind of file, the last column being a hash of all that was read: to be compared between runs with other
// fills, such as ASAN_OPTIONS=malloc_fill_byte=17:max_malloc_fill_size=100000000. Exit status 1: there are findings.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <new>
#include <string>
#include <vector>

#if defined(__GLIBC__)
#include <malloc.h>
#endif
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "readers/readers.hpp"
#include "same_bytes.hpp"

namespace {

using hmesh_test::same_bytes;

using File = std::vector<unsigned char>;

struct Seed {
    std::string kind;
    File bytes;
};

// What the processes that read count together: it lies in memory that they share.
struct Counts {
    std::uint64_t files, refused, differ, slow, died, hash;
};
struct Shared {
    std::uint64_t at;  // the number of the file that is being read
    Counts counts[32];
};

class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next() {  // splitmix64
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15U;
        z = (z ^ z >> 30U) * 0xbf58476d1ce4e5b9U;
        z = (z ^ z >> 27U) * 0x94d049bb133111ebU;
        return z ^ z >> 31U;
    }
    std::size_t below(std::size_t count) { return count == 0 ? 0 : static_cast<std::size_t>(next() % count); }

  private:
    std::uint64_t state_;
};

// Most of what matters stands in the first bytes.
std::size_t place(Random& random, const File& file) {
    return random.below(random.below(2) == 0 ? std::min<std::size_t>(file.size(), 64) : file.size());
}

void damage_once(Random& random, File& file) {
    static constexpr unsigned char extremes[] = {0, 1, 127, 128, 254, 255};
    const std::size_t at = place(random, file), length = std::min(file.size() - at, 1 + random.below(64));
    const auto first = file.begin() + static_cast<std::ptrdiff_t>(at);
    const auto last = first + static_cast<std::ptrdiff_t>(length);
    if (file.empty()) return;
    switch (random.below(8)) {
        case 0: file.resize(random.below(file.size())); break;                                                 // cut
        case 1: file[at] = static_cast<unsigned char>(file[at] ^ 1U << random.below(8)); break;                // a bit
        case 2: file[at] = static_cast<unsigned char>(random.next()); break;                                   // a byte
        case 3: file[at] = extremes[random.below(6)]; break;                                                   // the same
        case 4: std::generate(first, last, [&] { return static_cast<unsigned char>(random.next()); }); break;  // noise
        case 5: std::fill(first, last, extremes[random.below(6)]); break;                                      // a hole
        case 6: file.erase(first, last); break;                                                                // a gap
        default: {
            const File copy(first, last);
            file.insert(file.begin() + static_cast<std::ptrdiff_t>(place(random, file)), copy.begin(), copy.end());
        }
    }
}

// The check sums of a PNG file, CRC-32, so that what they guard is reached.
void mend_sums(File& file) {
    for (std::size_t at = 8; at + 12 <= file.size();) {
        const std::size_t size = tool::Bytes{file.data(), file.size()}.be32(at);
        if (size > file.size() - at - 12) return;
        std::uint32_t crc = 0xffffffffU;
        for (std::size_t k = at + 4; k < at + 8 + size; ++k) {
            crc ^= file[k];
            for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? 0xedb88320U ^ crc >> 1U : crc >> 1U;
        }
        for (std::size_t k = 0; k < 4; ++k) file[at + 8 + size + k] = static_cast<unsigned char>(~crc >> (24 - 8 * k));
        at += size + 12;
    }
}

File damaged(const Seed& seed, std::uint64_t number) {
    Random random(number);
    File file = seed.bytes;
    for (std::size_t k = 1 + random.below(4); k > 0; --k) damage_once(random, file);
    if (seed.kind == "png" && random.below(4) != 0) mend_sums(file);
    return file;
}

// What lies on the stack and comes from malloc() next.
void fill_memory(unsigned char with) {
#if defined(__GLIBC__)
    mallopt(M_PERTURB, with);
#endif
    volatile unsigned char stack[1U << 17U];
    for (volatile unsigned char& byte : stack) byte = with;
}

struct Outcome {
    std::string why;
    tool::ImageFile image;
};

Outcome read(const File& file, unsigned char fill) {
    fill_memory(fill);
    Outcome outcome;
    try {
        outcome.why = tool::read_bytes_as_image({file.data(), file.size()}, outcome.image);
    } catch (const std::bad_alloc&) {
        outcome.why = "there is not enough memory";
    }
    fill_memory(0);
    return outcome;
}

bool same(const Outcome& a, const Outcome& b) {
    if (a.why != b.why) return false;
    return !a.why.empty() ||
           (a.image.width == b.image.width && a.image.channels == b.image.channels &&
            same_bytes(a.image.samples8, b.image.samples8) && same_bytes(a.image.samples16, b.image.samples16) &&
            same_bytes(a.image.samples32, b.image.samples32));
}

std::uint64_t hash(std::uint64_t value, const void* bytes, std::size_t size) {  // FNV-1a
    const auto* at = static_cast<const unsigned char*>(bytes);
    for (std::size_t k = 0; k < size; ++k) value = (value ^ at[k]) * 0x100000001b3U;
    return value;
}

void keep(const std::string& folder, const char* what, const std::string& kind, std::uint64_t number, const File& file) {
    std::filesystem::create_directories(folder);
    const std::string name = folder + "/" + what + "-" + std::to_string(number) + "." + kind;
    std::ofstream(name, std::ios::binary)
        .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
    std::printf("%s\n", name.c_str());
}

void look_at(const File& file, Counts& counts, const std::string& kind, std::uint64_t number, const std::string& findings) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point begin = Clock::now();
    const Outcome one = read(file, 0x35), other = read(file, 0xca);
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    ++counts.files;
    if (!one.why.empty()) ++counts.refused;
    if (one.why.empty()) {
        const tool::ImageFile& image = one.image;
        counts.hash = hash(counts.hash ^ number, image.samples8.data(), image.samples8.size());
        counts.hash = hash(counts.hash, image.samples16.data(), image.samples16.size() * 2);
        counts.hash = hash(counts.hash, image.samples32.data(), image.samples32.size() * 4);
    } else {
        counts.hash = hash(counts.hash ^ number, one.why.data(), one.why.size());
    }
    if (!same(one, other)) {
        ++counts.differ;
        keep(findings, "differs", kind, number, file);
    }
    if (seconds > 10) {
        ++counts.slow;
        keep(findings, "slow", kind, number, file);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: damaged_images COUNT FOLDER [FINDINGS [FIRST]]\n");
        return 2;
    }
    const std::uint64_t first = argc > 4 ? std::strtoull(argv[4], nullptr, 10) : 0;
    const std::uint64_t end = first + std::strtoull(argv[1], nullptr, 10);
    const std::string findings = argc > 3 ? argv[3] : "findings";
    std::map<std::string, Seed> seeds;  // by name
    std::map<std::string, std::size_t> kinds;
    for (const auto& entry : std::filesystem::directory_iterator(argv[2])) {
        std::ifstream in(entry.path(), std::ios::binary);
        const std::string kind = entry.path().extension().string().substr(1);
        seeds[entry.path().filename().string()] = {kind, {std::istreambuf_iterator<char>(in), {}}};
        kinds.emplace(kind, kinds.size());
    }
    if (seeds.empty() || kinds.size() > 32) return 2;
    std::vector<const Seed*> list;
    for (const auto& [name, seed] : seeds) list.push_back(&seed);

    void* const memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) return 2;
    Shared& shared = *new (memory) Shared{};
    for (shared.at = first; shared.at < end;) {
        std::fflush(stdout);
        const pid_t child = fork();  // another process after each that ends badly
        if (child == 0) {
            for (; shared.at < end; ++shared.at) {
                const Seed& seed = *list[shared.at % list.size()];
                alarm(120);
                look_at(damaged(seed, shared.at), shared.counts[kinds[seed.kind]], seed.kind, shared.at, findings);
            }
            std::fflush(stdout);
            _exit(0);
        }
        int status = 0;
        if (child < 0 || waitpid(child, &status, 0) != child) return 2;
        if (shared.at >= end) break;
        const Seed& seed = *list[shared.at % list.size()];
        ++shared.counts[kinds[seed.kind]].died;
        keep(findings, "died", seed.kind, shared.at, damaged(seed, shared.at));
        ++shared.at;
    }
    std::uint64_t bad = 0;
    std::printf("kind     files   refused  differ  slow  died  hash\n");
    for (const auto& [kind, index] : kinds) {
        const Counts& of = shared.counts[index];
        std::printf("%-6s %7llu  %7llu  %6llu  %4llu  %4llu  %016llx\n", kind.c_str(), static_cast<unsigned long long>(of.files),
                    static_cast<unsigned long long>(of.refused), static_cast<unsigned long long>(of.differ),
                    static_cast<unsigned long long>(of.slow), static_cast<unsigned long long>(of.died),
                    static_cast<unsigned long long>(of.hash));
        bad += of.differ + of.slow + of.died;
    }
    return bad == 0 ? 0 : 1;
}
