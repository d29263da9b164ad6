// Error models of ranges and of the receiver clock, used alike by the simulator and the filter.
#pragma once

namespace schuler::sensor {

/// Errors of the ranges of one kind of source, one sigma, SI units. The correlated parts of range and range rate are independent
/// stationary first-order Gauss-Markov processes for each source.
struct RangeErrorModel {
    double white = 1.5;                   ///< m
    double correlated = 2.0;              ///< m (0: none)
    double correlation_time = 600.0;      ///< s
    double rate = 0.1;                    ///< m/s, white, of the range rate
    double correlated_rate = 0.0;         ///< m/s, of the range rate (0: none)
    double correlated_rate_time = 120.0;  ///< s
};

/// A receiver's oscillator by its Allan coefficients: white and random-walk frequency noise (math.md 5.2).
struct Oscillator {
    double h0 = 8e-20;        ///< s
    double h_minus2 = 4e-23;  ///< 1/s
    double bias = 300.0;      ///< m, c times its initial error, one sigma
    double drift = 10.0;      ///< m/s, likewise for its rate

    /// Densities of c times bias, m^2/s, and of its rate, m^2/s^3: c^2 h0/2 and 2 pi^2 c^2 h_-2.
    [[nodiscard]] double phase_psd() const { return 0.5 * c2 * h0; }
    [[nodiscard]] double frequency_psd() const { return 19.739208802178716 * c2 * h_minus2; }

private:
    static constexpr double c2 = 299'792'458.0 * 299'792'458.0;
};

/// Coefficients of two common kinds (math.md 5.2).
inline constexpr Oscillator ocxo{};
inline constexpr Oscillator tcxo{2e-19, 2e-20};

/// All errors of the ranges of one receiver. The network of ground stations has its own offset against the satellites' time.
struct RangingErrorModel {
    RangeErrorModel satellite;
    RangeErrorModel station{10.0, 5.0, 600.0, 0.1};
    double network = 10.0;         ///< m
    double network_time = 3600.0;  ///< s
    double intersystem = 30.0;     ///< m, constant offset of each further satellite system
    Oscillator clock;
    /// Averaging time of a range rate, s: the clock's white frequency noise over it is common to all the rates of an epoch, and not
    /// included in their stated sigmas. 0: the sigmas include it.
    double rate_span = 0.0;
};

}  // namespace schuler::sensor
