// The statistics of a campaign as bytes: identical for the same runs in any order.
#include "schuler/study/montecarlo/statistics.h"

#include <algorithm>

namespace schuler::study {
namespace {

/// One description of each struct serves both directions.
class Writer {
public:
    explicit Writer(Packer& to) : to_(to) {}
    template <class T>
        requires std::is_arithmetic_v<T>
    void operator()(const T& x) {
        to_.put(x);
    }
    void operator()(const bool& x) { to_.put(static_cast<std::uint8_t>(x)); }
    void operator()(const std::string& x) { to_.put(std::string_view(x)); }
    void operator()(const math::ExactSum& x) {
        for (const std::uint64_t limb : x.limbs) to_.put(limb);
        (*this)(x.overflow);
    }
    void operator()(const math::QuantileSketch& x) {
        const math::QuantileSketch::Content c = x.content();
        to_.put(static_cast<std::uint64_t>(c.values.size()));
        for (const double v : c.values) to_.put(v);
        to_.put(static_cast<std::uint64_t>(c.bins.size()));
        for (const auto& [bin, count] : c.bins) {
            to_.put(bin);
            to_.put(count);
        }
        to_.put(c.low);
        to_.put(c.high);
    }
    /// The number of elements of a vector or map.
    template <class Container>
    std::size_t size(const Container& c, std::size_t /*each*/) {
        to_.put(static_cast<std::uint64_t>(c.size()));
        return c.size();
    }

private:
    Packer& to_;
};

class Reader {
public:
    explicit Reader(Unpacker& from) : from_(from) {}
    template <class T>
        requires std::is_arithmetic_v<T>
    void operator()(T& x) {
        x = from_.get<T>();
    }
    void operator()(bool& x) { x = from_.get<std::uint8_t>() != 0; }
    void operator()(std::string& x) { x = from_.text(); }
    void operator()(math::ExactSum& x) {
        for (std::uint64_t& limb : x.limbs) limb = from_.get<std::uint64_t>();
        (*this)(x.overflow);
    }
    void operator()(math::QuantileSketch& x) {
        math::QuantileSketch::Content c;
        c.values.resize(from_.count(8));
        for (double& v : c.values) v = from_.get<double>();
        c.bins.resize(from_.count(12));
        for (auto& [bin, count] : c.bins) {
            bin = from_.get<std::int32_t>();
            count = from_.get<std::uint64_t>();
        }
        c.low = from_.get<double>();
        c.high = from_.get<double>();
        x.restore(std::move(c));
    }
    template <class Container>
    std::size_t size(const Container& /*c*/, std::size_t each) {
        return from_.count(each);
    }

private:
    Unpacker& from_;
};

template <class Archive, class Value>
void values(Archive& a, Value& v) {
    a(v.square);
    a(v.sketch);
}

template <class Archive, class Block>
void block(Archive& a, Block& b) {
    for (auto& e : b.error) values(a, e);
    a(b.nees);
    a(b.settled_nees);
    a(b.count);
    a(b.settled);
}

template <class Archive, class E>
void epoch(Archive& a, E& e) {
    a(e.time_s);
    for (auto& b : e.block) {
        const std::size_t n = a.size(b, 1);
        if constexpr (!std::is_const_v<E>) b.resize(std::min<std::size_t>(n, 1));
        for (auto& one : b) block(a, one);
    }
}

template <class Archive, class Measurement>
void measurement(Archive& a, Measurement& x) {
    a(x.nis);
    a(x.dof);
    a(x.lag1);
    a(x.accepted);
    a(x.rejected);
}

template <class Archive, class Outage>
void outage(Archive& a, Outage& o) {
    a(o.start_s);
    a(o.duration_s);
    for (auto& v : o.size) values(a, v);
    a(o.runs);
    a(o.inside);
}

template <class Archive, class Point>
void point(Archive& a, Point& p) {
    a(p.runs);
    a(p.failed);
    a(p.epochs);
    a(p.nees_runs);
    for (auto& s : p.square) a(s);
    a(p.nees);
    a(p.end_square);
    a(p.ends);
}

/// A map: keys and elements.
template <class Key, class Archive, class Map, class Each>
void map(Archive& a, Map& m, Each each) {
    const std::size_t n = a.size(m, sizeof(std::uint64_t));
    if constexpr (std::is_const_v<Map>) {
        for (const auto& [key, x] : m) {
            a(key);
            each(a, x);
        }
    } else {
        m.clear();
        for (std::size_t i = 0; i < n; ++i) {
            Key key{};
            a(key);
            each(a, m[key]);
        }
    }
}

template <class Archive, class Statistics>
void whole(Archive& a, Statistics& s) {
    a(s.epoch_step);
    a(s.runs);
    a(s.failed);
    a(s.first_run);
    a(s.head.scheme);
    a(s.head.mechanization);
    a(s.head.loop);
    a(s.head.smoothed);
    a(s.head.settled_s);
    for (auto& f : s.fields) {
        a(f.square);
        a(f.epochs);
        a(f.largest);
        values(a, f.runs);
        a(f.size);
    }
    for (auto& b : s.components)
        for (auto& v : b) values(a, v);
    for (auto& n : s.nees) {
        a(n.sum);
        a(n.square);
        a(n.runs);
        a(n.epochs);
    }
    map<std::int64_t>(a, s.epochs, [](auto& to, auto& x) { epoch(to, x); });
    map<std::string>(a, s.measurements, [](auto& to, auto& x) { measurement(to, x); });
    const std::size_t n = a.size(s.outages, 8);
    if constexpr (!std::is_const_v<Statistics>) s.outages.resize(n);
    for (auto& o : s.outages) outage(a, o);
    map<std::uint64_t>(a, s.points, [](auto& to, auto& x) { point(to, x); });
    a(s.swept);
    map<std::uint64_t>(a, s.failures, [](auto& to, auto& x) {
        to(x.seed);
        to(x.reason);
    });
    map<std::string>(a, s.warnings.topics, [](auto& to, auto& x) {
        to(x.first_run);
        to(x.seed);
        to(x.runs);
        to(x.text);
    });
}

}  // namespace

void CampaignStatistics::pack(Packer& to) const {
    Writer writer(to);
    whole(writer, *this);
}

void CampaignStatistics::unpack(Unpacker& from) {
    Reader reader(from);
    whole(reader, *this);
}

}  // namespace schuler::study
