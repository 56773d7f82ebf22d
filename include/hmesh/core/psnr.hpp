/// \file
/// psnr_of_energy(): how much of an image is lost, in dB.
#ifndef HMESH_CORE_PSNR_HPP
#define HMESH_CORE_PSNR_HPP

#include <cmath>

#include "hmesh/core/finite.hpp"

#include "hmesh/core/macros/push.hpp"

namespace hmesh::kit {

/// 10 log10(peak^2 / MSE), MSE = energy / samples the mean over pixels AND channels. Infinity for energy 0, or below, where
/// rounding left less than nothing.
[[nodiscard]] inline double psnr_of_energy(double energy, double samples, double peak) noexcept {
    return energy <= 0 ? detail::infinity() : 10 * std::log10(peak * peak * samples / energy);
}

}  // namespace hmesh::kit

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_PSNR_HPP
