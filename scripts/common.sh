# Sourced by the scripts beside it. Changes to the root of the repository and defines need, step and jobs.
# shellcheck shell=bash disable=SC2034
set -eu -o pipefail
unset CDPATH
# Asked for help, all of them print what they say of themselves, and do nothing.
case ${1-} in
    -h | --help)
        awk 'NR > 1 && !/^#/ { exit } NR > 1 && !/shellcheck/ { sub(/^# ?/, ""); print }' "$0"
        exit
        ;;
esac
start_directory=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# How many compilers may run at once.
jobs=${HMESH_JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)}

fail() {
    printf '%s\n' "$*" >&2
    exit 1
}

# step TEXT COMMAND...: prints TEXT and runs COMMAND, whose output is shown only if it fails.
step() {
    local log status=0
    printf '%s\n' "$1"
    shift
    log=$(mktemp)
    "$@" >"$log" 2>&1 </dev/null || status=$?
    [ "$status" = 0 ] || cat "$log" >&2
    rm -f "$log"
    [ "$status" = 0 ] || fail "failed: $*"
}

has() { command -v "$1" >/dev/null 2>&1; }

# The folders in which headers of others may lie: Eigen's, and stb's and GDAL's where they are not flat in the folder above.
include_folders=()
for folder in /usr/include /usr/local/include /opt/homebrew/include; do
    include_folders+=(-isystem "$folder/eigen3" -isystem "$folder/stb" -isystem "$folder/gdal")
done
include_folders+=(-isystem /opt/homebrew/include)
export include_words="${include_folders[*]}"  # for shells that xargs starts: a list cannot be exported

# in_large_pages COMMAND...: runs what is made of clang in memory of large pages, as glibc asks Linux for them, which takes a seventh
# of its time. (g++ takes a twentieth more with them, and what starts often has one to clear each time.)
in_large_pages() { GLIBC_TUNABLES=glibc.malloc.hugetlb=1 "$@"; }
export -f in_large_pages

# clang_tidy ARGUMENT...: runs clang-tidy, and prints what it says only if it fails, without how many warnings it kept to itself.
# For shells that xargs starts, too.
clang_tidy() {
    local said
    said=$(in_large_pages "${CLANG_TIDY:-$(command -v clang-tidy-14 || echo clang-tidy)}" --quiet "$@" 2>&1) && return
    printf '%s\n' "$said" | grep -v '^[0-9]* warnings\? generated\|^Suppressed ' >&2
    return 1
}
export -f clang_tidy

has_header() {
    printf '#include <%s>\n' "$1" | "${CXX:-c++}" -x c++ -E "${include_folders[@]}" - >/dev/null 2>&1
}

# Whether a python3 has it, and Pillow: of the path, or the system's.
has_pytest() { python_with PIL pytest >/dev/null; }

# python_with MODULE...: prints the first python3, of the path or the system's, that has all of these modules; false: none has.
python_with() {
    local python
    for python in $(type -ap python3) /usr/bin/python3; do
        ! "$python" -c "import $(IFS=, && printf %s "$*")" 2>/dev/null || { printf '%s\n' "$python" && return 0; }
    done
    return 1
}

has_fuzzer() {
    printf 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }\n' |
        clang++ -x c++ -fsanitize=fuzzer,address -o /dev/null - >/dev/null 2>&1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# need WHAT...: makes sure that what each of the words below stands for is there. What is missing is installed where the system
# has apt-get; elsewhere one sentence says what to install.
need() {
    local what packages=() optional=()
    for what in "$@"; do
        case $what in
            compiler) has "${CXX:-c++}" || packages+=(g++) ;;
            cmake)
                has cmake || packages+=(cmake)
                has make || packages+=(make)
                ;;
            eigen) has_header signature_of_eigen3_matrix_library || packages+=(libeigen3-dev) ;;
            command)  # what tools/hmesh and tools/terrain are made of, beside Eigen
                has_header stb_image.h || packages+=(libstb-dev)
                has_header CLI/CLI.hpp || packages+=(libcli11-dev)
                has_header nlohmann/json.hpp || packages+=(nlohmann-json3-dev)
                # what reads image files best, without which it is built too
                has_header png.h || optional+=(libpng-dev)
                has_header jpeglib.h || optional+=(libjpeg-dev)
                has_header webp/demux.h || optional+=(libwebp-dev)
                has_header tiffio.h || optional+=(libtiff-dev)
                has_header meshoptimizer.h || optional+=(libmeshoptimizer-dev)  # compresses .glb
                # reads models of heights: some 90 packages and 20 seconds
                has_header gdal.h || optional+=(libgdal-dev)
                ;;
            stb) has_header stb_image.h || packages+=(libstb-dev) ;;
            pytest) has_pytest || packages+=(python3 python3-pil python3-pytest) ;;
            python-package)  # what packaging/python is built and tested with
                python_with pybind11 numpy setuptools wheel pip pytest PIL ensurepip sysconfig >/dev/null ||
                    packages+=(python3-pybind11 python3-dev python3-numpy python3-setuptools python3-wheel python3-pip
                               python3-venv python3-pytest python3-pil)
                ;;
            doctest) has_header doctest/doctest.h || packages+=(doctest-dev) ;;
            benchmark) has_header benchmark/benchmark.h || packages+=(libbenchmark-dev) ;;
            opengl)  # what examples draw with
                has_header EGL/egl.h || packages+=(libegl-dev)
                has_header GL/glext.h || packages+=(libopengl-dev libgl-dev)
                has_header SDL2/SDL.h || packages+=(libsdl2-dev)
                ;;
            ninja) has ninja || packages+=(ninja-build) ;;
            clang) has clang++ || packages+=(clang) ;;
            clang-format | clang-tidy) has "$what-14" || has "$what" || packages+=("$what") ;;
            doxygen) has doxygen || packages+=(doxygen) ;;
            clang-sanitizers)  # libFuzzer among them
                has clang++ || packages+=(clang)
                has_fuzzer || packages+=(libclang-rt-dev)
                ;;
            coverage)
                has g++ && has gcov || packages+=(g++)
                has gcovr || packages+=(gcovr)
                ctags --version 2>/dev/null | grep -q Universal || packages+=(universal-ctags)
                ;;
            clang-*) has "clang++-${what#clang-}" || packages+=("$what") ;;
            m32) printf '#include <vector>\n' | g++ -m32 -x c++ -fsyntax-only - 2>/dev/null || packages+=(g++-multilib) ;;
            mingw) has x86_64-w64-mingw32-g++-posix || packages+=(g++-mingw-w64-x86-64) ;;
            wine) has wine || packages+=(wine wine64) ;;
            g++-aarch64 | g++-s390x) has "${what#g++-}-linux-gnu-g++" || packages+=("$what-linux-gnu") ;;
            qemu) has qemu-aarch64 || packages+=(qemu-user) ;;
            emscripten) has em++ || packages+=(emscripten) ;;
            node) has node || packages+=(nodejs) ;;
            browser)  # what tests of pages run
                has "${CHROMIUM:-chromium}" || packages+=(chromium)
                has node || packages+=(nodejs)
                has npm || packages+=(npm)
                ;;
            viewers)  # what the tests of that label show meshes with
                has pdftoppm || packages+=(poppler-utils)
                has gs || packages+=(ghostscript)
                has rsvg-convert || packages+=(librsvg2-bin)
                has assimp || packages+=(assimp-utils)
                has admesh || packages+=(admesh)
                has "${CHROMIUM:-chromium}" || packages+=(chromium)
                has node || packages+=(nodejs)
                has npm || packages+=(npm)
                ;;
            *) fail "need: unknown '$what'" ;;
        esac
    done
    if [ ${#optional[@]} != 0 ] && has apt-get && { [ "$(id -u)" = 0 ] || has sudo; }; then
        printf 'Installing %s ...\n' "${optional[*]}"
        install_packages "${optional[@]}" >/dev/null 2>&1 </dev/null ||
            printf 'They could not be installed: fewer image files will be read.\n' >&2
    fi
    [ ${#packages[@]} != 0 ] || return 0
    if ! has apt-get; then
        fail "Please install what these Debian packages hold, with your system's package manager: ${packages[*]}."
    elif [ "$(id -u)" != 0 ] && ! has sudo; then
        fail "Please run this as root: apt-get install ${packages[*]}"
    fi
    step "Installing ${packages[*]} ..." install_packages "${packages[@]}"
}

install_packages() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q || true  # the packages may be known already
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends "$@"
}

# need_node_modules DIRECTORY: makes sure that node finds what the tests labelled `viewers` need, in DIRECTORY/node_modules.
# Of Playwright only the library: it drives the system's Chromium.
need_node_modules() {
    export NODE_PATH=$1/node_modules${NODE_PATH:+:$NODE_PATH}
    ! node -e 'require("gltf-validator"), require("playwright-core"), require("@here/quantized-mesh-decoder")' 2>/dev/null || return 0
    printf 'Installing gltf-validator, playwright-core and quantized-mesh-decoder into %s ...\n' "$1"
    mkdir -p "$1"
    env PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD=1 npm install --prefix "$1" --no-save --no-audit --no-fund \
        gltf-validator@2.0.0-dev.3.10 playwright-core@1.65.1 @here/quantized-mesh-decoder@1.2.8 >"$1/npm.log" 2>&1 </dev/null ||
        printf 'They could not be installed, see %s: tests that need them will be skipped.\n' "$1/npm.log" >&2
}
