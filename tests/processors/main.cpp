// Do files compiled for different processors get on in one program? Exit status 77 where this one has no AVX2.
#include <cmath>
#include <cstdio>

double generic_part();
double wide_part();

int main() {
    if (!__builtin_cpu_supports("avx2")) return 77;
    const double generic = generic_part(), wide = wide_part();
    std::printf("%.10g %.10g\n", generic, wide);
    return std::abs(generic - wide) < 1e-9 * generic ? 0 : 1;
}
