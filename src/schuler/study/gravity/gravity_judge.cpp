// Usability of a survey, and the changes at its steps.
#include "schuler/core/units.h"
#include "schuler/study/gravity/gravity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::study {
namespace {

using Eigen::Vector3d;
using gravimetry::SurveyEpoch;

/// Beyond these the linear error model, or the assumptions about the instruments, are not valid. A consistent filter refuses
/// fewer than one fix in ten thousand, and its NIS is one within a percent or two.
constexpr double largest_nis = 2.0, largest_refused = 0.01;
constexpr double open_loop_bands = 1.5;  ///< half widths of the 95 % band of the NIS: three sigma
constexpr double most_sigmas = 5.0;      ///< sigmas, if the truth is known

/// Fraction of positions refused after settling.
double refused_share(const GravityBundle& b) {
    double refused = 0.0, all = 0.0;
    for (const filter::MeasurementRecord& r : b.survey.measurements) {
        if (r.kind != filter::MeasurementKind::GnssPosition || r.stamp < b.run.evaluation.settled ||
            r.status == filter::MeasurementStatus::Withheld)
            continue;
        all += 1.0;
        refused += r.status == filter::MeasurementStatus::Rejected ? 1.0 : 0.0;
    }
    return all > 0.0 ? refused / all : 0.0;
}

}  // namespace

std::string dependence_of_innovations(const GravityBundle& b) {
    const gravimetry::InnovationRun& r = b.biased;
    const std::string channel = fmt::format("{} {}", std::array{"north", "east", "vertical"}[static_cast<std::size_t>(r.axis)],
                                            r.kind == filter::MeasurementKind::GnssPosition ? "position" : "velocity");
    if (r.throughout)
        return fmt::format(
            "the innovations of the {} are not independent, their means over {:.0f} s scatter by {:.2g} of their sigma: the "
            "disturbance or an accelerometer varies in another way than the model (gravity.model, gravity.steps_s), or the fixes "
            "have slower errors",
            channel, r.length, r.sigmas);
    return fmt::format(
        "the innovations of the {} have a mean of {:.2g} sigma from {:.0f} to {:.0f} s: gravity or an accelerometer changes there "
        "in a way that the model does not have (a step: name its time in gravity.steps_s), or the fixes have slower errors",
        channel, r.sigmas, b.run.relative(r.from), b.run.relative(r.to));
}

GravityVerdict gravity_verdict(const GravityBundle& b) {
    GravityVerdict out;
    const auto refuse = [&](std::string why) {
        out.usable = false;
        out.reasons.push_back(std::move(why));
    };
    const SurveyEpoch& last = b.epochs().back();
    if (!last.disturbance_n.allFinite() || !last.sigma_disturbance_n.allFinite())
        refuse("its covariance is not positive definite");
    if (b.innovations.nis > largest_nis)
        refuse(fmt::format("the fixes deviate by more than the filter predicts (NIS {:.3g} a degree of freedom, 1 expected)",
                           b.innovations.nis));
    // The gate itself refuses its share of good fixes, more than the default of 1e-4 if the user wants it so.
    const double by_gate = 3.0 * b.run.data.config.filter.constraints.gate_probability;
    if (const double share = refused_share(b); share > std::max(largest_refused, by_gate))
        refuse(fmt::format("{:.2g} % of the fixes were refused: the errors have left what a linear model of them can follow{}",
                           100.0 * share,
                           b.run.data.config.filter.loop == fusion::Loop::Open
                               ? "; an open loop holds for about an hour, take --loop closed or mixed"
                               : ""));
    // A variable part follows what it was not made for, with a lag; a constant cannot.
    if (b.biased.significant() && b.run.data.config.gravity.model == gravimetry::DisturbanceKind::Constant)
        refuse(dependence_of_innovations(b));
    // An open loop leaves the range of the linear model gradually. The innovations show it first.
    const double band = b.innovations.high - 1.0;
    if (b.run.data.config.filter.loop == fusion::Loop::Open && b.innovations.nis > 1.0 + open_loop_bands * band)
        refuse(fmt::format(
            "the loop is open, and the innovations (NIS {:.3g}, at most {:.3g} in 95 of 100 consistent runs) show errors "
            "beyond its linear model; take --loop closed or mixed",
            b.innovations.nis, b.innovations.high));
    if (b.truth.empty()) return out;
    constexpr std::array names{"north", "east", "vertical"};
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        const double off = std::abs(b.errors.last(axis)) / last.sigma_disturbance_n(axis);
        if (off > most_sigmas)
            refuse(fmt::format("the {} disturbance is off by {:.3g} of its sigmas", names[static_cast<std::size_t>(axis)], off));
    }
    return out;
}

std::vector<GravityChange> gravity_changes(const GravityBundle& b, const GravityInput& input) {
    std::vector<GravityChange> out;
    if (input.steps.empty()) return out;
    // The initial accelerometer errors are absorbed by the level, whose prior is increased accordingly: the sum is well known.
    // Later bias changes are represented by its state, as a random walk from zero.
    filter::Settings settings = input.filter;
    fusion::Start start = input.start;
    // The same applies to scale factors and misalignments, which convert the specific force at rest to a bias.
    sensor::ImuErrorModel& errors = settings.imu.errors;
    const double constant =
        std::hypot(start.std_accel_bias.maxCoeff(), units::g0 * errors.accel_scale, units::g0 * errors.accel_misalignment);
    constexpr double nothing = 1e-9;  // m/s^2
    errors.accel_turn_on_bias = nothing;
    errors.accel_scale = errors.accel_misalignment = 0.0;
    start.std_accel_bias.setConstant(nothing);
    for (double& prior : settings.disturbance.prior_n) prior = std::hypot(prior, constant);
    settings.disturbance.keep_before = true;
    const gravimetry::SurveyResult survey =
        gravimetry::run_survey(input.data, settings, start, {.smooth = false, .steps = input.steps});
    for (std::size_t k = 0; k < input.steps.size(); ++k) {
        // The last epoch before the next step: one at its time already has the clone of then.
        const Time end = k + 1 < input.steps.size() ? input.steps[k + 1] : Time{INT64_MAX};
        const auto after = std::ranges::find_if(survey.forward, [&](const SurveyEpoch& e) { return e.time >= end; });
        if (after == survey.forward.begin() || survey.forward.front().time >= input.steps[k]) continue;
        const SurveyEpoch& last = *(after - 1);
        if (last.time > input.steps[k]) out.push_back({b.run.relative(input.steps[k]), last.change_n, last.sigma_change_n});
    }
    return out;
}

}  // namespace schuler::study
