#include "schuler/filter/integrity/refused_fixes.h"

#include <algorithm>
#include <cmath>

namespace schuler::filter {

using Eigen::Vector3d;

void RefusedRun::add(Time time, const Vector3d& innovation, double sigma) {
    last_ = {time, innovation};
    sigma_ = std::max(sigma_, sigma);
    if (count_++ % every_ != 0) return;
    if (kept_ == samples_.size()) {
        for (std::size_t i = 1; 2 * i < kept_; ++i) samples_[i] = samples_[2 * i];
        kept_ /= 2;
        every_ *= 2;
        if ((count_ - 1) % every_ != 0) return;
    }
    samples_[kept_++] = last_;
}

RefusedRun::Line RefusedRun::line(std::size_t first, std::size_t end) const {
    Line l{Vector3d::Zero(), Vector3d::Zero()};
    const auto n = static_cast<double>(end - first);
    double mean_t = 0.0, tt = 0.0;
    for (std::size_t i = first; i < end; ++i) {
        mean_t += (samples_[i].time - samples_[0].time).seconds() / n;
        l.mean += samples_[i].innovation / n;
    }
    for (std::size_t i = first; i < end; ++i) {
        const double t = (samples_[i].time - samples_[0].time).seconds() - mean_t;
        tt += t * t;
        l.rate += t * (samples_[i].innovation - l.mean);
    }
    if (tt > 0.0) l.rate /= tt;
    else l.rate.setZero();
    return l;
}

Vector3d RefusedRun::mean() const { return kept_ > 0 ? line(0, kept_).mean : Vector3d(Vector3d::Zero()); }

Vector3d RefusedRun::rate() const { return kept_ > 1 ? line(0, kept_).rate : Vector3d(Vector3d::Zero()); }

RunShape RefusedRun::shape(double drift) const {
    if (kept_ < 4 || span() < 2.0) return RunShape::Short;
    const Line all = line(0, kept_);
    const auto n = static_cast<double>(kept_);
    const double mean_t = 0.5 * span(), size = all.mean.norm();
    double scatter = 0.0;
    for (std::size_t i = 0; i < kept_; ++i) {
        const double t = (samples_[i].time - samples_[0].time).seconds() - mean_t;
        scatter = std::max(scatter, (samples_[i].innovation - all.mean - t * all.rate).norm());
    }
    const double change = all.rate.norm() * span();
    // of a straight line through n measurements along its length, and of the estimate itself
    const double change_sigma = std::sqrt(3.0 * (12.0 / n * sigma_ * sigma_ + std::pow(drift * span(), 2)));
    if (scatter > 6.0 * sigma_ + 0.5 * std::max(change, 0.5 * size)) return RunShape::Erratic;
    if (change < std::min(0.4 * size, std::max(0.2 * size, 3.0 * change_sigma))) return RunShape::Constant;
    const Line first = line(0, (kept_ + 1) / 2), second = line(kept_ / 2, kept_);
    const double turn = 4.0 * sigma_ / std::max(span(), 1.0) * std::sqrt(96.0 / n);
    return second.rate.norm() > 1.5 * first.rate.norm() + turn ? RunShape::Growing : RunShape::Uniform;
}

namespace {

/// How much likelier the first fix after an interruption was at its level than at another, at `innovation + other`: difference of
/// the squared normalised innovations; components with sigma 0 are unused.
double favours_first(const Vector3d& innovation, const Vector3d& other, const Vector3d& sigma) {
    double difference = 0.0;
    for (int i = 0; i < 3; ++i)
        if (sigma[i] > 0.0)
            difference += (std::pow(innovation[i] + other[i], 2) - std::pow(innovation[i], 2)) / std::pow(sigma[i], 2);
    return difference;
}

}  // namespace

void FixLevels::interrupted(const Vector3d& innovation, const Vector3d& sigma) {
    anew = true;
    anew_innovation = innovation;
    anew_sigma = sigma;
    here_anew = 0.0;
}

void FixLevels::confirm(bool other_one, double dt, double most) {
    (other_one ? there : here) += std::clamp(dt, 0.0, most);
    used += other_one ? 1 : 0;
    if (!other_one) here_anew += std::clamp(dt, 0.0, most);
    const bool came_back = two && at_other && !other_one;  // it has returned to its own level
    if (came_back || (!other_one && there < 0.01 * here)) {
        two = false;
        there = 0.0;
    }
    at_other = two && other_one;
}

void FixLevels::jumped(const Vector3d& innovation, double sigma, double held, bool settled) {
    two = at_other = true;
    other = innovation;
    there = held;
    unsure = sigma;
    used = 0;
    if (!settled) here = std::min(here, 30.0);
    if (!anew) return;
    constexpr double decisive = 9.0;  // squared sigmas
    const double here_favoured = favours_first(anew_innovation, other, anew_sigma);
    if (here_favoured < -decisive) there += here - here_anew;  // the other level continues what was before
    if (here_favoured < decisive) here = here_anew;
}

void FixLevels::swap() {
    std::swap(here, there);
    other = -other;
    at_other = !at_other;
    anew = false;
}

Vector3d FixLevels::spread() const {
    if (!two) return Vector3d::Zero();
    if (at_other) return undecided_part * other;
    const double w = there / std::max(here + there, 1.0);
    return std::min(undecided_part, std::sqrt(w * (1.0 - w))) * other;
}

void FixChannel::fit(Time time, const Vector3d& innovation, double sigma) {
    fitted = time;
    fitted_sigma = sigma;
    fitted_innovation = innovation;
    sum = fits > 0 ? Vector3d(sum + innovation) : innovation;
    ++fits;
    run.clear();
}

bool FixChannel::began_at_once() const {
    if (!fitted || run.count() == 0) return false;
    return (run.since() - *fitted).seconds() < interruption && fitted_innovation.norm() < 0.5 * run.mean().norm();
}

}  // namespace schuler::filter
