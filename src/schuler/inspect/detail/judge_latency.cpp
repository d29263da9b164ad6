// Latency of each GNSS channel from three comparisons: velocity with IMU, position with IMU, velocity with position.
#include "schuler/inspect/detail/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace schuler::inspect::detail {
namespace {

/// A measured age, s.
struct Age {
    double value;
    double sigma;
    std::string from;
};

// Errors not covered by the jackknife: interpolation, filtering in the receiver and in the IMU.
constexpr double floor_sigma = 0.015, floor_sigma_down = 0.04;

/// Steps, waves and vibrations repeat: of several ages that fit alike, the one nearest to `expected`, less sure and with the others told.
std::optional<Age> age_of(const Agreement& a, double expected, double least_contrast, double floor, const char* from) {
    if (!a.found || a.contrast < least_contrast || a.sigma > 0.1) return std::nullopt;
    const double at = a.nearest_to(expected);
    std::string others;
    const auto tell = [&](double t) {
        if (t != at) others += fmt::format("{}{:.2f}", others.empty() ? "" : ", ", t);
    };
    tell(a.at);
    for (const double t : a.rivals) tell(t);
    return Age{
        at, std::hypot(a.sigma, floor),
        others.empty() ? std::string(from) : fmt::format("{}; the motion is periodic, with further fits at {} s", from, others)};
}

std::optional<Age> better(const std::optional<Age>& a, const std::optional<Age>& b) {
    if (!a) return b;
    if (!b) return a;
    return a->sigma <= b->sigma ? a : b;
}

std::optional<Age> sum(const std::optional<Age>& a, const std::optional<Age>& b, double sign, const char* from) {
    if (!a || !b) return std::nullopt;
    return Age{a->value + sign * b->value, std::hypot(a->sigma, b->sigma), from};
}

std::string text_of(const Age& age) { return fmt::format("{:.3f} +- {:.3f} s", age.value, age.sigma); }

double confidence_of(const Age& age) { return age.sigma < 0.03 ? 0.95 : age.sigma < 0.06 ? 0.8 : 0.6; }

bool significant(double difference, double sigma) { return std::abs(difference) > std::max(3.0 * sigma, 0.03); }

struct Ages {
    std::optional<Age> position, velocity, height, velocity_down, relative, relative_down;
};

Ages measured(const Study& study) {
    constexpr double typical = 0.1;  // s, of receivers
    const Given& given = study.given;
    const double position = study.position_age + given.latency.value_or(typical),
                 velocity = study.velocity_age + given.velocity_latency.value_or(given.latency.value_or(typical));
    // unless both are given, positions and velocities of one instant
    const double behind = given.velocity_latency && given.latency ? velocity - position : study.velocity_age - study.position_age;
    Ages ages;
    const std::optional<Age> v =
        age_of(study.velocity_fit.horizontal, velocity, 0.2, std::hypot(floor_sigma, lag_by_gain(study.velocity_fit)),
               "fit of the IMU to the velocity");
    const std::optional<Age> p =
        age_of(study.position_fit.horizontal, position, 0.2, std::hypot(floor_sigma, lag_by_gain(study.position_fit)),
               "fit of the IMU to the displacement");
    ages.relative = age_of(study.velocity_behind_position, behind, 0.2, 0.005, "displacement against velocity");
    ages.relative_down =
        age_of(study.down_velocity_behind_height, behind, 0.2, floor_sigma, "height change against vertical velocity");
    ages.position = better(p, sum(v, ages.relative, -1.0, "velocity against IMU and position"));
    ages.velocity = better(v, sum(p, ages.relative, 1.0, "position against IMU and velocity"));
    const auto of = [](const std::optional<Age>& age, double otherwise) { return age ? age->value : otherwise; };
    if (study.gnss.has_height)
        ages.height = age_of(study.position_fit.down,
                             given.height_latency ? study.position_age + *given.height_latency : of(ages.position, position), 0.3,
                             floor_sigma_down, "fit of the IMU to height changes");
    ages.velocity_down =
        age_of(study.velocity_fit.down,
               given.velocity_down_latency ? study.velocity_age + *given.velocity_down_latency : of(ages.velocity, velocity), 0.3,
               floor_sigma_down, "fit of the IMU to the vertical velocity");
    return ages;
}

void report(Study& study, const char* key, const std::optional<Age>& age, double stated, bool is_stated) {
    if (!age) return;
    std::string why = age->from;
    if (is_stated) {
        why += fmt::format("; the log's own time of validity gives {:.3f} s: {}", stated,
                           significant(age->value - stated, age->sigma) ? "the data disagree" : "the data agree");
    }
    study.found(key, text_of(*age), confidence_of(*age), why);
}

// Hundredths of a second: the limit of agreement between the fits.
double rounded(double age) { return std::round(100.0 * age) / 100.0; }

// One key of the draft: the latency to be added to the ages stated in the log, if the measured age differs from the default.
double draft_latency(Study& study, const char* key, const std::optional<Age>& age, double stated, bool is_stated, double used) {
    if (!age) return used;
    const std::string stated_text = is_stated ? fmt::format(", beyond the {:.2f} s that the log states", stated) : std::string();
    if (significant(age->value - stated - used, age->sigma)) {
        study.draft.set("gnss", key, rounded(age->value - stated),
                        fmt::format("{}: {} measured{}", how_sure(confidence_of(*age)), text_of(*age), stated_text), true,
                        Known::Found, age->sigma);
        return age->value - stated;
    }
    if (std::string_view(key) == "latency_s" && !is_stated && age->sigma > 0.003) {
        study.draft.set("gnss", key, std::string("estimate"),
                        fmt::format("{} measured here; the filter finds it better", text_of(*age)));
        return used;
    }
    study.draft.set("gnss", key, rounded(used),
                    fmt::format("{} measured{}: no reason for a change", text_of(*age),
                                is_stated ? fmt::format(", {:.2f} s stated", stated) : std::string()),
                    false);
    return used;
}

/// Uncertainty of a latency for the filter: that of the measurement, within the accuracy of the fits. A time of validity
/// stated in the log itself (`stated`) is accepted unless contradicted by the data, in which case the difference is its
/// uncertainty.
void draft_uncertainty(Study& study, const char* key, const std::optional<Age>& age, std::optional<double> stated) {
    const double off = stated && age ? std::abs(age->value - *stated) : 0.0;
    constexpr double doubtful = 2.0;  // sigmas
    if (stated && !(age && off > doubtful * age->sigma)) return;
    constexpr double least = 0.02, most = 0.15;  // s: difference between two fits of one log, and typical receiver latency
    const bool stays = stated && !significant(off, age->sigma);
    const double sigma = std::clamp(!age ? most : stays ? std::max(off, age->sigma) : age->sigma, least, most);
    study.draft.set(
        "gnss", key, std::round(1000.0 * sigma) / 1000.0,
        age ? "one sigma of it; the filter estimates what is left" : "it could not be measured; the filter looks for it", true);
}

/// `apart`: the data show a separate latency of the velocity.
void draft_uncertainties(Study& study, const Ages& ages, bool apart) {
    const Given& given = study.given;
    const auto stated = [](bool is_stated, double age) { return is_stated ? std::optional(age) : std::nullopt; };
    if (!given.latency)
        draft_uncertainty(study, "latency_std_s", ages.position, stated(study.states_position_age, study.position_age));
    // A single given latency applies to both, unless the data show otherwise.
    if (study.gnss.has_velocity() && !given.velocity_latency && (!given.latency || apart))
        draft_uncertainty(study, "velocity_latency_std_s", ages.velocity, stated(study.states_velocity_age, study.velocity_age));
}

/// A given latency is added to the ages stated in the log: the data may show that it is counted twice, or wrong. Beyond doubt the
/// data are used; else the given value, with the difference as sigma for the filter. Returns the value used. @param otherwise
/// value used if nothing had been given or measured
double check_given(Study& study, const char* key, double given, const std::optional<Age>& age, double stated, bool is_stated,
                   double otherwise) {
    if (!age || !significant(age->value - stated - given, age->sigma)) return given;
    const std::string beyond =
        is_stated ? fmt::format(" on top of the {:.3f} s that a column of the file accounts for", stated) : std::string();
    const double shown = age->value - stated, off = std::abs(shown - given);
    const std::string full = std::string("gnss.") + key;
    const std::string text = fmt::format("{:.3f} s is given{}; the data show {:.3f} +- {:.3f} s{} ({})", given, beyond, shown,
                                         age->sigma, is_stated ? " beyond it" : "", age->from);
    constexpr double beyond_doubt = 10.0, least = 0.1;  // sigmas; s
    const bool refuted = off > std::max(beyond_doubt * age->sigma, least);
    const std::string_view name(key);
    const bool has_sigma = name == "latency_s" || name == "velocity_latency_s";
    const std::string sigma_key = std::string(key, name.size() - 2) + "_std_s";
    if (has_sigma && !refuted)
        study.draft.set("gnss", sigma_key, std::round(1000.0 * off) / 1000.0, "what the given one and the data differ by");
    if (has_sigma && refuted) draft_uncertainty(study, sigma_key.c_str(), age, is_stated ? std::optional(stated) : std::nullopt);
    if (!refuted) {
        study.contradicts(full, text);
        return given;
    }
    // as if not given
    if (significant(shown - otherwise, age->sigma)) {
        study.refutes(full, text, FactValue(rounded(shown)), age->sigma);
        return shown;
    }
    study.refutes(full, text,
                  name == "latency_s" && !is_stated ? std::optional<FactValue>(std::string("estimate")) : std::nullopt);
    return otherwise;
}

/// Sensors dated by the fixes logged beside them are early by what the receiver takes to put these out. To the motion that looks like a
/// latency of the fixes; but theirs are the right times.
void attribute_to_sensors(Study& study, Ages& ages) {
    const Given& given = study.given;
    if (!study.imu_file->by_arrival || given.latency || given.velocity_latency || given.has("imu.time_offset_s")) return;
    const std::optional<Age>& shown = ages.position ? ages.position : ages.velocity;
    if (!shown) return;
    const double delay = rounded(shown->value - (ages.position ? study.position_age : study.velocity_age));
    if (!significant(delay, shown->sigma) || delay < 0.0) return;
    study.clock_shift += delay;
    study.clock_sigma = std::hypot(study.clock_sigma, shown->sigma);
    study.clock_evidence +=
        fmt::format("{}the sensors are dated by the fixes logged beside them, which the receiver puts out {:.2f} s late",
                    study.clock_evidence.empty() ? "" : "; ", delay);
    for (std::optional<Age>* age : {&ages.position, &ages.velocity, &ages.height, &ages.velocity_down})
        if (*age) (*age)->value -= delay;
}

}  // namespace

void judge_latency(Study& study) {
    if (study.gnss_file == nullptr || study.gnss_file->computed) return;
    if (study.states_position_age) {
        study.states("gnss.stated_position_age_s", study.position_age, "column of the time of validity; latencies count on top");
        study.found("gnss.stated_position_age", fmt::format("{:.3f} s", study.position_age), 1.0,
                    "column of the time of validity; applied when reading");
    }
    if (study.states_velocity_age) {
        study.states("gnss.stated_velocity_age_s", study.velocity_age, "column of the time of validity; latencies count on top");
        study.found("gnss.stated_velocity_age", fmt::format("{:.3f} s", study.velocity_age), 1.0,
                    "column of the time of validity; applied when reading");
        study.draft.note("gnss", fmt::format("the file's own times of validity are used: position {:.2f} s, velocity {:.2f} s "
                                             "older than the stamp; latencies add to them",
                                             study.position_age, study.velocity_age));
    }
    Ages ages = measured(study);
    if (study.imu_file != nullptr) attribute_to_sensors(study, ages);
    report(study, "gnss.latency_s", ages.position, study.position_age, study.states_position_age);
    report(study, "gnss.velocity_latency_s", ages.velocity, study.velocity_age, study.states_velocity_age);
    report(study, "gnss.velocity_behind_position_s", ages.relative, study.velocity_age - study.position_age,
           study.states_velocity_age);
    report(study, "gnss.height_latency_s", ages.height, study.position_age, study.states_position_age);
    report(study, "gnss.velocity_down_latency_s", ages.velocity_down, study.velocity_age, study.states_velocity_age);
    report(study, "gnss.down_velocity_behind_height_s", ages.relative_down, study.velocity_age - study.position_age,
           study.states_velocity_age);
    if (!ages.position && !ages.velocity) {
        if (ages.relative &&
            significant(ages.relative->value - (study.velocity_age - study.position_age), ages.relative->sigma)) {
            study.draft.set("gnss", "velocity_latency_s",
                            rounded(ages.relative->value - (study.velocity_age - study.position_age)),
                            fmt::format("{}: {} behind the position; the position itself could not be compared with the IMU",
                                        how_sure(confidence_of(*ages.relative)), text_of(*ages.relative)),
                            true, Known::Found, ages.relative->sigma);
        } else {
            study.draft.set("gnss", "latency_s", 0.0,
                            "could not be measured: too little motion or no time in common; \"estimate\" has the filter find it",
                            false);
        }
        draft_uncertainties(study, ages, false);
        return;
    }
    const Given& given = study.given;
    if (given.height_latency)
        check_given(study, "height_latency_s", *given.height_latency, ages.height, study.position_age, study.states_position_age,
                    0.0);
    const double used =
        given.latency
            ? check_given(study, "latency_s", *given.latency, ages.position, study.position_age, study.states_position_age, 0.0)
            : draft_latency(study, "latency_s", ages.position, study.position_age, study.states_position_age, 0.0);
    double used_velocity = used;
    if (study.gnss.has_velocity()) {
        // The comparison with the position is more accurate, if the latency of the position is confirmed.
        std::optional<Age> velocity = ages.velocity;
        const double position = study.position_age + used;
        if (ages.relative && ages.position && std::abs(ages.position->value - position) < 1.5 * ages.position->sigma) {
            velocity = Age{position + ages.relative->value, ages.relative->sigma, ages.relative->from};
        }
        if (given.velocity_down_latency)
            check_given(study, "velocity_down_latency_s", *given.velocity_down_latency, ages.velocity_down, study.velocity_age,
                        study.states_velocity_age, used);
        used_velocity = given.velocity_latency ? check_given(study, "velocity_latency_s", *given.velocity_latency, velocity,
                                                             study.velocity_age, study.states_velocity_age, used)
                                               : draft_latency(study, "velocity_latency_s", velocity, study.velocity_age,
                                                               study.states_velocity_age, used);
        // All three components come from one solution. Receivers filter the vertical more than the horizontal, never less: a
        // vertical velocity that appears earlier is off by a period of steps or waves.
        if (ages.velocity_down && ages.velocity_down->value < study.velocity_age + used_velocity) ages.velocity_down.reset();
        draft_latency(study, "velocity_down_latency_s", ages.velocity_down, study.velocity_age, study.states_velocity_age,
                      used_velocity);
    }
    draft_latency(study, "height_latency_s", ages.height, study.position_age, study.states_position_age, used);
    draft_uncertainties(study, ages, used_velocity != used);
}

}  // namespace schuler::inspect::detail
