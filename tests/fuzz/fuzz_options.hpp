// hmesh tests - options and recipes of mesh_image() drawn from the bytes of a fuzzer: usual, unusual and absurd ones.
#ifndef HMESH_TESTS_FUZZ_FUZZ_OPTIONS_HPP
#define HMESH_TESTS_FUZZ_FUZZ_OPTIONS_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <variant>

#include "fuzz_input.hpp"
#include "hmesh/paper.hpp"

namespace hmesh_test {

using Recipe = std::variant<hmesh::Annealed, hmesh::Hierarchical, hmesh::Xie, hmesh::Adams, hmesh::AdaptiveThinning>;

// What a program asks for.
struct Request {
    hmesh::Options options;
    Recipe recipe;
    bool linear_light = false;  // colors are fitted for it afterwards
};

class RequestDraw {
  public:
    explicit RequestDraw(FuzzInput& input) : input_(&input), is_wild_(input.one_in(4)) {}

    // For an image of this size. Ranges are those that mean something, cut where work would take minutes.
    [[nodiscard]] Request request(int width, int height) {
        Request request;
        hmesh::Options& options = request.options;
        target(options.target, std::int64_t{width} * height);
        const unsigned method = input_->byte() % 5;
        hmesh::Annealed annealed;
        choice(annealed.effort, 4);
        annealed.seed = input_->byte();
        if (input_->one_in(4)) limits(options.limits);
        if (input_->one_in(4)) whole(annealed.tile, 64, 128);
        if (input_->one_in(4)) {
            options.colors = hmesh::Colors::optimal;
            choice(*options.colors, 2);
        }
        options.round_colors = !input_->one_in(4);
        if (input_->one_in(4)) request.linear_light = input_->flag();
        options.premultiplied = input_->one_in(4);
        const bool is_plain = !input_->one_in(3);
        switch (method) {
            case 1: put<hmesh::Hierarchical>(request.recipe, is_plain); break;
            case 2: put<hmesh::Xie>(request.recipe, is_plain); break;
            case 3: put<hmesh::Adams>(request.recipe, is_plain); break;
            case 4: request.recipe = hmesh::AdaptiveThinning(); break;
            default:
                if (!is_plain) draw(annealed.steps.emplace(hmesh::kit::annealed_steps(annealed.effort)));
                request.recipe = annealed;
        }
        return request;
    }

  private:
    void target(hmesh::Target& target, std::int64_t pixels) {
        choice(target.kind, 3);
        const double most = static_cast<double>(std::min<std::int64_t>(pixels, 200)), share = input_->share();
        const double few = share * share;  // few vertices more often than many, which take longer
        switch (target.kind) {
            case hmesh::Target::Kind::vertices: target.value = 4 + std::floor(few * std::max(0.0, most - 4)); break;
            case hmesh::Target::Kind::percent: target.value = few * 100 * most / static_cast<double>(pixels); break;
            default: target.value = 1 + 60 * share;
        }
        if (is_wild_ && input_->one_in(8)) target.value = input_->wild_real();
    }
    void limits(hmesh::MeshLimits& limits) {
        real(limits.min_double_area, 1e-4, 0.25);
        real(limits.border_gap, 1.0 / 256, 0.25);
        real(limits.color_overshoot, 0, 100);
        real(limits.ridge, 1e-9, 1);
    }
    template <class Paper>
    void put(Recipe& recipe, bool is_plain) {
        Paper paper;
        if (!is_plain) draw(paper);
        recipe = paper;
    }
    void draw(hmesh::kit::AnnealedSteps& options) {
        real(options.points, 1, 10);
        whole(options.settle_rounds, 0, 5);
        real(options.settle_flip_gain, 0, 1);
        real(options.collapse_batch, 0.02, 1);
        whole(options.polish_rounds, 0, 5);
        for (hmesh::kit::Tolerance* tolerance : {&options.settle, &options.polish}) {
            real(tolerance->propagate_above, 0, 1);
            real(tolerance->min_gain, 0, 1);
        }
        whole(options.relaxation.rounds, 0, 4);
        real(options.relaxation.min_gain, 0, 1);
        whole(options.annealing.sweeps, 0, 10);
        whole(options.annealing.nudges, 0, 20);
        for (double* value : {&options.annealing.temperature, &options.annealing.cooling, &options.annealing.removal_screen,
                              &options.annealing.insertion_screen, &options.annealing.flip_screen})
            real(*value, 0, 100);
        for (double* value : {&options.annealing.try_probability, &options.annealing.jump, &options.annealing.jump_reach,
                              &options.annealing.count_tolerance})
            real(*value, 0, 1);
        real(options.annealing.start_price, 1e-6, 1e6);
    }
    void draw(hmesh::Adams& options) {
        real(options.density, 1, 1000);
        whole(options.smoothing, 0, 20);
    }
    void draw(hmesh::Xie& options) {
        draw(options.start);
        whole(options.search.first_step, 1, 4096);
        whole(options.search.visits, 1, 20);
        whole(options.flip_visits, 1, 1000);
        whole(options.rounds, 0, 10);
        real(options.enough, 0, 1);
    }
    void draw(hmesh::Hierarchical& options) {
        draw(options.start);
        whole(options.levels, 1, 4);
        whole(options.bilateral.diameter, 1, 15);
        real(options.bilateral.sigma_color, 1e-3, 1e3);
        real(options.bilateral.sigma_space, 1e-3, 1e3);
        if (input_->one_in(4)) options.filter = rude_filter;
        options.start_filtered = !input_->one_in(3);
        choice(options.geometry.search, 3);
        choice(options.geometry.rule, 2);
        real(options.geometry.color_scale, 1e-3, 1e3);
        real(options.geometry.ridge, 1e-9, 1e3);
        whole(options.geometry.halvings, 0, 20);
        whole(options.geometry.pcg.max_iterations, 1, 1000);
        real(options.geometry.pcg.tolerance, 1e-15, 1);
        whole(options.rounds, 0, 4);
        whole(options.flip_visits, 1, 1000);
    }
    // A user's filter that gives what is no sample.
    static void rude_filter(const float* from, float* to, int width, int height, int channels) {
        const std::int64_t count = std::int64_t{width} * height * channels;
        for (std::int64_t k = 0; k < count; ++k)
            to[k] = k % 5 == 0   ? std::numeric_limits<float>::quiet_NaN()
                    : k % 7 == 0 ? -std::numeric_limits<float>::infinity()
                    : k % 3 == 0 ? 1e38F
                                 : from[count - 1 - k];
    }

    // Half of all stay as they are.
    void real(double& value, double low, double high) {
        const unsigned how = input_->byte() % 8;
        if (how == 7 && is_wild_) value = input_->wild_real();
        else if (how == 6) value = low;
        else if (how == 5) value = high;
        else if (how == 4) value = low + input_->share() * (high - low);
    }
    void whole(int& value, int low, int high) {
        const unsigned how = input_->byte() % 8;
        if (how == 7 && is_wild_) value = input_->wild_int();
        else if (how == 6) value = low;
        else if (how == 5) value = high;
        else if (how == 4) value = input_->within(low, high);
    }
    template <class Enum>
    void choice(Enum& value, unsigned known) {
        const unsigned number = input_->byte();
        if (number == 0) return;
        value = static_cast<Enum>(is_wild_ && number >= 128 ? number : number % known);
    }

    FuzzInput* input_;
    bool is_wild_;
};

// Whether an option that counts has a value that is none of its enumerators.
[[nodiscard]] inline bool names_nothing_known(const Request& request) {
    const auto beyond = [](auto value, auto last) { return value > last; };
    const hmesh::Options& options = request.options;
    const auto* const annealed = std::get_if<hmesh::Annealed>(&request.recipe);
    const auto* const hierarchical = std::get_if<hmesh::Hierarchical>(&request.recipe);
    return beyond(options.target.kind, hmesh::Target::Kind::psnr) ||
           (options.colors && beyond(*options.colors, hmesh::Colors::sampled)) ||
           (annealed != nullptr && !annealed->steps && beyond(annealed->effort, hmesh::Effort::best)) ||
           (hierarchical != nullptr && (beyond(hierarchical->geometry.search, hmesh::kit::FootSearch::one_ring) ||
                                        beyond(hierarchical->geometry.rule, hmesh::kit::StepRule::literal)));
}

}  // namespace hmesh_test

#endif  // HMESH_TESTS_FUZZ_FUZZ_OPTIONS_HPP
