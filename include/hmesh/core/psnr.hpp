/// \file
/// psnr_of_energy(): the PSNR of a sum of squared differences, in dB.
#ifndef HMESH_CORE_PSNR_HPP
#define HMESH_CORE_PSNR_HPP

#include <cmath>

#include "hmesh/core/finite.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// 10 log10(peak^2 / MSE) in dB, MSE = energy / samples. `energy`: sum of squared differences; `samples`: pixels times
/// channels, so that the MSE is the mean over pixels AND channels. Infinity for energies <= 0 (rounding may leave a negative
/// sum).
[[nodiscard]] inline double psnr_of_energy(double energy, double samples, double peak) noexcept {
    return energy <= 0 ? detail::infinite() : 10 * std::log10(peak * peak * samples / energy);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_PSNR_HPP
