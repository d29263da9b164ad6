#include "schuler/gravimetry/classical.h"

#include "schuler/core/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<double> low_passed(const std::vector<double>& t, const std::vector<double>& x, double period) {
    const double sigma = period * std::sqrt(0.5 * std::numbers::ln2) / std::numbers::pi;
    std::vector<double> out(x.size());
    std::size_t first = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        while (t[i] - t[first] > 4.0 * sigma) ++first;
        double sum = 0.0, weights = 0.0;
        for (std::size_t j = first; j < x.size() && t[j] - t[i] <= 4.0 * sigma; ++j) {
            const double weight = std::exp(-0.5 * std::pow((t[j] - t[i]) / sigma, 2));
            sum += weight * x[j];
            weights += weight;
        }
        out[i] = sum / weights;
    }
    return out;
}

std::vector<double> classical_disturbance(const earth::Earth& earth, const Vector3d& lever_arm_b,
                                          const std::vector<GnssFix>& fixes, const std::vector<SurveyEpoch>& forward,
                                          double period) {
    const std::size_t n = forward.size();
    if (n < 3) throw input_error("fewer than three fixes lie within the IMU log", {}, "gravimetry needs a longer log");
    std::vector<double> t(n), h(n), raw(n);
    for (std::size_t i = 0; i < n; ++i) {
        t[i] = (forward[i].time - forward.front().time).seconds();
        const Vector3d antenna = earth::ecef_from_geodetic(earth.ellipsoid, fixes[forward[i].fix].position).r;
        h[i] = earth::geodetic_from_ecef(earth.ellipsoid, Ecef{antenna - forward[i].nav.q_eb * lever_arm_b}).h;
    }
    for (std::size_t i = 1; i + 1 < n; ++i) {
        const double before = t[i] - t[i - 1], after = t[i + 1] - t[i];
        const double climb = 2.0 * ((h[i + 1] - h[i]) / after - (h[i] - h[i - 1]) / before) / (before + after);
        const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, forward[i].nav.position);
        const Matrix3d C_ne = earth::C_en(place.lat, place.lon).transpose();
        const Vector3d v_n = C_ne * forward[i].nav.v_eb_e;
        const earth::EarthTerms terms = earth::terms_at(earth, place, v_n);
        const double eotvos = (2.0 * terms.w_ie_n + terms.w_en_n).cross(v_n).z();
        const double f_down = 0.5 * (forward[i].f_n.z() + forward[i + 1].f_n.z());
        raw[i] = -climb - f_down + eotvos - terms.g_n.z();
    }
    raw.front() = raw[1];
    raw.back() = raw[n - 2];
    return low_passed(t, raw, period);
}

}  // namespace schuler::gravimetry
