// The navigator fed with arbitrary samples in any order: whatever comes in, what goes out is finite, its covariance positive definite, and
// what was saved is restored.
#include "schuler/filter/navigator.h"

#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"

#include <Eigen/Cholesky>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace {

using namespace schuler;

/// What is left of the input; zeros after its end.
class Bytes {
public:
    Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
    [[nodiscard]] bool empty() const { return left_ == 0; }
    std::uint8_t byte() { return left_ == 0 ? std::uint8_t{0} : (--left_, *data_++); }
    /// From -1 to 1, in steps.
    double fraction() { return (byte() - 128) / 128.0; }
    Eigen::Vector3d fractions(double scale) {
        const double x = fraction(), y = fraction(), z = fraction();
        return scale * Eigen::Vector3d(x, y, z);
    }
    /// Any bits, infinities and NaN among them.
    double any() {
        std::array<std::uint8_t, sizeof(double)> bits{};
        for (std::uint8_t& b : bits) b = byte();
        double value = 0.0;
        std::memcpy(&value, bits.data(), sizeof value);
        return value;
    }
    Eigen::Vector3d any3() {
        const double x = any(), y = any(), z = any();
        return {x, y, z};
    }

private:
    const std::uint8_t* data_;
    std::size_t left_;
};

void require(bool holds) {
    if (!holds) std::abort();
}

void check(const filter::NavigatorState& state) {
    require(state.nav.v_eb_n.allFinite() && std::isfinite(state.nav.position.lat) && std::isfinite(state.nav.position.lon) &&
            std::isfinite(state.nav.position.h));
    require(state.covariance.allFinite());
    const Eigen::Matrix<double, 9, 1> sigma = state.covariance.diagonal().cwiseSqrt();
    require((sigma.array() > 0.0).all());
    const Eigen::Matrix<double, 9, 9> correlation =
        sigma.cwiseInverse().asDiagonal() * state.covariance * sigma.cwiseInverse().asDiagonal();
    // 1e-9 for rounding: a correlation of nearly one is an eigenvalue of nearly zero.
    require((correlation + 1e-9 * Eigen::Matrix<double, 9, 9>::Identity()).llt().info() == Eigen::Success);
}

filter::NavigatorSettings settings_of(std::uint8_t choice) {
    filter::NavigatorSettings s;
    s.imu_interval = 0.02;
    s.filter.vehicle = (choice & 1) != 0 ? filter::VehicleKind::Car : filter::VehicleKind::Air;
    s.filter.scale_factors = (choice & 2) != 0;
    s.filter.constraints.nonholonomic = (choice & 1) != 0;
    s.rates = {.gnss = 10.0, .baro = 10.0, .mag = 10.0, .odometer = 10.0, .heading = 10.0};
    if ((choice & 8) != 0) {
        s.rates.gauges = s.rates.log = 10.0;
        s.rates.gauge_count = 3;
    }
    if ((choice & 16) != 0) {
        s.filter.coupling = filter::Coupling::Tight;
        s.filter.ranging.protection.use = (choice & 32) != 0;
        s.rates.ranges = 10.0;
        s.rates.range_sources = 16;
    }
    if ((choice & 4) == 0) {
        filter::Start start;
        start.nav.time = Time{};
        start.nav.position = {0.9, 0.5, 100.0};
        start.nav.v_eb_n.setZero();
        start.nav.q_nb = Eigen::Quaterniond::Identity();
        start.std_position.setConstant(5.0);
        start.std_velocity.setConstant(0.5);
        start.std_rpy = Eigen::Vector3d(0.02, 0.02, 0.1);
        start.std_gyro_bias.setConstant(1e-3);
        start.std_accel_bias.setConstant(0.05);
        s.start = start;
    }
    return s;
}

class Feeder {
public:
    Feeder(filter::Navigator& navigator, Bytes& bytes) : navigator_(navigator), bytes_(bytes) {}

    void step() {
        const std::uint8_t what = bytes_.byte();
        const Time late = time_ - Duration{bytes_.byte() * std::int64_t{4'000'000}};
        switch (what % 16) {
            case 0: inertial(1 + what / 16 * 16); break;
            case 1: (void)navigator_.feed(ImuSample{advance(), bytes_.any3(), bytes_.any3()}); break;
            case 2: {
                GnssFix fix{.time = late,
                            .position = {0.9 + 1e-4 * bytes_.fraction(), 0.5 + 1e-4 * bytes_.fraction(),
                                         100.0 + 300.0 * bytes_.fraction()}};
                fix.velocity_n = bytes_.fractions(30.0);
                fix.std_position.setConstant(0.01 + std::abs(bytes_.fraction()));
                (void)navigator_.feed(fix);
                break;
            }
            case 3: {
                GnssFix fix{.time = late, .position = {bytes_.any(), bytes_.any(), bytes_.any()}};
                fix.velocity_n = bytes_.any3();
                fix.std_position = bytes_.any3();
                fix.std_velocity = bytes_.any3();
                fix.position_age = bytes_.any();
                (void)navigator_.feed(fix);
                break;
            }
            case 4: (void)navigator_.feed(BaroSample{late, 100.0 + 50.0 * bytes_.fraction(), not_given}); break;
            case 5: (void)navigator_.feed(BaroSample{late, bytes_.any(), bytes_.any()}); break;
            case 6: (void)navigator_.feed(MagSample{late, bytes_.fractions(6e-5)}); break;
            case 7: (void)navigator_.feed(MagSample{late, bytes_.any3()}); break;
            case 8: (void)navigator_.feed(OdometerSample{late, 30.0 * bytes_.fraction(), 0.1}); break;
            case 9: (void)navigator_.feed(OdometerSample{late, bytes_.any(), bytes_.any()}); break;
            case 10: (void)navigator_.feed(HeadingSample{late, 3.0 * bytes_.fraction(), 0.02}); break;
            case 11: (void)navigator_.feed(HeadingSample{late, bytes_.any(), bytes_.any()}); break;
            case 12: time_ = Time{static_cast<std::int64_t>(1e9 * 30.0 * bytes_.fraction()) + time_.ns}; break;
            case 13: repeat(); break;
            case 14: inertial(1 + what / 16); break;
            default:
                if (what == 0xff) navigator_.restart();
                else survey(what / 16, late);
        }
        look();
    }

private:
    Time advance() { return time_ = time_ + Duration{20'000'000}; }

    void inertial(int count) {
        const Eigen::Vector3d rate = bytes_.fractions(0.5), force = bytes_.fractions(3.0) - Eigen::Vector3d(0.0, 0.0, 9.81);
        for (int k = 0; k < count; ++k) (void)navigator_.feed(ImuSample{advance(), rate, force});
    }

    /// Gauges, velocity log and ranges, usual ones and any bits.
    void survey(int which, Time late) {
        switch (which) {
            case 1: (void)navigator_.feed(GaugeSample{late, Eigen::Vector3d::Constant(100.0) + bytes_.fractions(20.0)}); break;
            case 2: (void)navigator_.feed(GaugeSample{late, bytes_.any3()}); break;
            case 3: (void)navigator_.feed(BodyVelocitySample{late, bytes_.fractions(20.0)}); break;
            case 4: (void)navigator_.feed(BodyVelocitySample{late, bytes_.any3()}); break;
            case 5:
            case 6: ranges(which == 6, late); break;
            default: inertial(2);
        }
    }

    /// An epoch of up to eight satellites, 20 000 km from the place where the drive begins.
    void ranges(bool any, Time time) {
        const Eigen::Vector3d here = earth::ecef_from_geodetic(earth::wgs84, {0.9, 0.5, 100.0}).r;
        std::array<RangeSample, 8> samples;
        const std::size_t count = bytes_.byte() % (samples.size() + 1);
        for (std::size_t i = 0; i < count; ++i) {
            RangeSample& s = samples[i];
            const char name[] = {'G', '0', static_cast<char>('1' + i), '\0'};
            const auto source = navigator_.range_source(name, i == 7);
            s.source = source.value_or(static_cast<std::uint16_t>(i));
            if (any) {
                s.source = bytes_.byte();
                s.pseudorange = bytes_.any(), s.range_rate = bytes_.any(), s.std = bytes_.any();
                s.tx.r = bytes_.any3(), s.tx_velocity = bytes_.any3(), s.tx_clock = bytes_.any();
                continue;
            }
            const Eigen::Vector3d direction = (here.normalized() + bytes_.fractions(0.8)).normalized();
            s.tx.r = here + 2e7 * direction;
            s.tx_velocity = bytes_.fractions(3000.0);
            s.pseudorange = 2e7 + 100.0 * bytes_.fraction();
            s.range_rate = s.tx_velocity.dot(direction) + 10.0 * bytes_.fraction();
            s.std = 0.1 + std::abs(bytes_.fraction());
        }
        (void)navigator_.feed(time, {samples.data(), count});
    }

    /// Saved and restored it is the same; bytes that were spoilt are refused or at least do no harm.
    void repeat() {
        std::vector<std::byte> saved = navigator_.save();
        require(navigator_.restore(saved) == filter::RestoreStatus::Restored);
        require(navigator_.save() == saved);
        saved[saved.size() * bytes_.byte() / 256] ^= std::byte{1};
        if (navigator_.restore(saved) != filter::RestoreStatus::Restored) return;
        navigator_.restart();
    }

    void look() {
        if (const auto state = navigator_.state()) check(*state);
        if (const auto state = navigator_.lagged()) check(*state);
        while (navigator_.poll()) {}
        while (const auto row = navigator_.poll_row()) require(row->v_eb_n.allFinite() && row->std_position.allFinite());
    }

    filter::Navigator& navigator_;
    Bytes& bytes_;
    Time time_{};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2 || size > 4096) return 0;
    Bytes bytes(data, size);
    filter::NavigatorMade made = filter::Navigator::make(settings_of(bytes.byte()));
    require(made.navigator.has_value());
    Feeder feeder(*made.navigator, bytes);
    while (!bytes.empty()) feeder.step();
    return 0;
}
