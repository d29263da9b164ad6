// The embedded core at work: a drive fed to the navigator and to the attitude filter, their states on the standard output, and what they
// need of the stack and of the heap on the error output. scripts/embedded.sh runs it on several processors and compares.
#include "drive.h"

#include "embedded/fail_handler.h"
#include "schuler/ahrs/mekf.h"
#include "schuler/filter/navigator.h"
#include "schuler/math/rotation.h"

#include <alloca.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <optional>
#include <span>
#include <string_view>

namespace {

std::size_t allocations = 0, allocated = 0;

void* counted(std::size_t size, std::size_t alignment) {
    ++allocations;
    allocated += size;
    void* p = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (p == nullptr) std::abort();
    return p;
}

}  // namespace

void* operator new(std::size_t size) { return counted(size == 0 ? 1 : size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) { return counted(size, static_cast<std::size_t>(alignment)); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

// Between the two an instruction counter counts (scripts/embedded.sh finds them by their names).
extern "C" {
[[gnu::noinline]] void feed_begins() { asm volatile(""); }
[[gnu::noinline]] void feed_ends() { asm volatile(""); }
}

namespace {

using namespace schuler;
constexpr double interval = embedded::Drive::interval;

bool due(int k, double every) { return k % static_cast<int>(std::lround(every / interval)) == 0; }

constexpr std::size_t painted = 512 * 1024;
constexpr unsigned char paint = 0xA5;

/// Paints the stack below the caller.
[[gnu::noinline]] void paint_stack() {
    void* stack = alloca(painted);
    std::memset(stack, paint, painted);
    asm volatile("" : : "r"(stack) : "memory");
}
/// How deep the paint is gone since, bytes; `painted` means that or more.
[[gnu::noinline]] std::size_t deepest() {
    std::size_t fresh = 0;
    std::memset(&fresh, paint, sizeof fresh);
    const volatile auto* stack = static_cast<const volatile std::size_t*>(alloca(painted));
    std::size_t intact = 0;
    while (intact < painted / sizeof fresh && stack[intact] == fresh) ++intact;
    return painted - intact * sizeof fresh;
}

[[noreturn]] void refused(const char* what) {
    std::fprintf(stderr, "refused: %s\n", what);
    std::exit(2);
}

enum class Kind { Geographic, EarthFixed, Tight };
constexpr const char* names[] = {"geographic", "ecef", "tight"};

filter::NavigatorSettings settings(Kind kind) {
    filter::NavigatorSettings s;
    s.filter.vehicle = filter::VehicleKind::Car;
    s.filter.imu.errors = sensor::imu_grade("mems");
    s.filter.scale_factors = true;
    s.filter.constraints.nonholonomic = true;
    s.filter.mechanization = kind == Kind::EarthFixed ? filter::Mechanization::Ecef : filter::Mechanization::Geographic;
    s.filter.gnss.estimate_std = false;
    s.imu_interval = embedded::Drive::interval;
    s.rates.gnss = 10.0;
    s.rates.baro = 20.0;
    if (kind != Kind::Tight) return s;
    s.filter.coupling = filter::Coupling::Tight;
    s.filter.ranging.corrections.troposphere = gnss::TroposphereModel::None;
    s.filter.ranging.protection.use = true;
    s.rates.ranges = 10.0;
    s.rates.range_sources = 16;
    return s;
}

void print(const char* name, const filter::NavigatorState& s) {
    const Geodetic& p = s.nav.position;
    const Eigen::Vector3d &v = s.nav.v_eb_n, rpy = math::rpy_from_quaternion(s.nav.q_nb);
    std::printf("%s %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g", name, s.nav.time.seconds(), p.lat, p.lon, p.h,
                v.x(), v.y(), v.z(), rpy.x(), rpy.y(), rpy.z());
    for (int i = 0; i < 9; ++i) std::printf(" %.17g", std::sqrt(s.covariance(i, i)));
    std::printf("\n");
}

void print(double t, const ahrs::Mekf& attitude) {
    const Eigen::Vector3d rpy = math::rpy_from_quaternion(attitude.q_nb()), std = attitude.std_phi(), b = attitude.gyro_bias();
    std::printf("attitude %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", t, rpy.x(), rpy.y(), rpy.z(), std.x(),
                std.y(), std.z(), b.x(), b.y(), b.z());
}

/// The whole drive by one navigator; what it says every ten seconds. True where it navigates and has taken no memory since `make`.
bool navigate(Kind kind, double seconds) {
    const char* name = names[static_cast<int>(kind)];
    std::size_t of_make = 0, of_feed = 0, of_state = 0;
    const filter::NavigatorSettings chosen = settings(kind);
    const std::size_t before = allocated;
    paint_stack();
    filter::NavigatorMade made = filter::Navigator::make(chosen);
    of_make = deepest();
    if (!made) refused(made.reason.c_str());
    filter::Navigator& navigator = *made.navigator;
    const std::size_t memory = allocated - before, allocations_before = allocations;

    embedded::Drive drive;
    const auto fed = [&](const auto&... sample) {
        feed_begins();
        (void)navigator.feed(sample...);
        feed_ends();
    };
    for (std::size_t i = 0; kind == Kind::Tight && i < embedded::Drive::sources; ++i)
        (void)navigator.range_source(std::array{"G01", "G02", "G03", "G04", "G05", "G06", "G07", "G08"}[i], false);
    paint_stack();
    for (int k = 1; k * interval <= seconds; ++k) {
        const double t = k * interval;
        if (due(k, embedded::Drive::fix_interval)) fed(drive.fix(t));
        if (due(k, embedded::Drive::baro_interval)) fed(drive.baro(t));
        if (kind == Kind::Tight && due(k, embedded::Drive::fix_interval)) {
            const std::array<RangeSample, embedded::Drive::sources> ranges = drive.ranges(t);
            fed(embedded::Drive::time(t), std::span<const RangeSample>(ranges));
        }
        fed(drive.imu(t));
        if (!due(k, 10.0)) continue;
        of_feed = std::max(of_feed, deepest());
        paint_stack();
        const std::optional<filter::NavigatorState> now = navigator.state();
        of_state = std::max(of_state, deepest());
        if (now) print(name, *now);
        paint_stack();
    }
    const std::size_t later = allocations - allocations_before;
    std::fprintf(stderr,
                 "%s: heap at make %zu bytes, allocations after it %zu; stack of make %zu bytes, of feed %zu, of state %zu\n",
                 name, memory, later, of_make, of_feed, of_state);
    return later == 0 && navigator.phase() == filter::Phase::Navigating;
}

bool attitude_only(double seconds) {
    const std::size_t before = allocations;
    ahrs::Mekf attitude{ahrs::MekfSettings{}};
    embedded::Drive drive;
    std::size_t of_step = 0;
    paint_stack();
    for (int k = 1; k * interval <= seconds; ++k) {
        const double t = k * interval;
        const ImuSample imu = drive.imu(t);
        const Eigen::Vector3d field = drive.field(t);
        attitude.forward_speed(embedded::Drive::speed(t), 0.1);
        feed_begins();
        (void)attitude.step(interval, imu.gyro, imu.accel);
        if (due(k, embedded::Drive::field_interval)) attitude.magnetometer(field);
        feed_ends();
        if (!due(k, 10.0)) continue;
        of_step = std::max(of_step, deepest());
        print(t, attitude);
        paint_stack();
    }
    std::fprintf(stderr, "attitude: %zu bytes, allocations %zu; stack of step %zu bytes\n", sizeof attitude, allocations - before,
                 of_step);
    return allocations == before && attitude.started();
}

}  // namespace

/// embedded_drive [SECONDS [geographic|ecef|tight|attitude]]
int main(int count, char** arguments) {
    set_fail_handler(refused);
    const double seconds = count > 1 ? std::atof(arguments[1]) : 120.0;
    const std::string_view only = count > 2 ? arguments[2] : "";
    bool good = true;
    for (const Kind kind : {Kind::Geographic, Kind::EarthFixed, Kind::Tight})
        if (only.empty() || only == names[static_cast<int>(kind)]) good = navigate(kind, seconds) && good;
    if (only.empty() || only == "attitude") good = attitude_only(seconds) && good;
    return good ? 0 : 1;
}
