/* The state of a live run in shared memory: the layout of /dev/shm/NAME of an output "shm:NAME". Plain C, for readers in any language.
 *
 * A writer makes `sequence` odd, writes, and makes it even: a copy is whole if the sequence was the same even number before and after
 * (schuler_shared_read). `heartbeat_ns` is the writer's CLOCK_MONOTONIC: an old one means that the run hangs or was killed. */
#ifndef SCHULER_LIVE_SHARED_STATE_H
#define SCHULER_LIVE_SHARED_STATE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SCHULER_SHARED_MAGIC "SCHULER1"

struct schuler_shared_state {
    char magic[8];          /* SCHULER_SHARED_MAGIC, without a terminator */
    uint32_t size;          /* bytes of this structure; members may be added at the end */
    uint32_t running;       /* 1; 0 once the run has ended */
    uint64_t sequence;      /* odd while a state is being written */
    uint64_t count;         /* of states written */
    int64_t heartbeat_ns;   /* CLOCK_MONOTONIC of the writer */
    int64_t time_ns;        /* of the state, on the axis of the samples */
    double position[3];     /* latitude, longitude in deg, height above the ellipsoid in m */
    double velocity[3];     /* north, east, down, m/s */
    double attitude[3];     /* roll, pitch, heading (0 to 360), deg */
    double std_position[3]; /* north, east, down, m, one sigma */
    double std_velocity[3]; /* m/s */
    double std_attitude[3]; /* deg */
};

/* Copies a whole state. 1: done; 0: none written yet, or the writer stopped in the middle; -1: not this layout. */
static inline int schuler_shared_read(const volatile struct schuler_shared_state* shared, struct schuler_shared_state* copy) {
    int attempt;
    unsigned i;
    for (i = 0; i < sizeof shared->magic; ++i)
        if (shared->magic[i] != SCHULER_SHARED_MAGIC[i]) return -1;
    if (shared->size < sizeof *copy) return -1;
    for (attempt = 0; attempt < 1000000; ++attempt) {
        const uint64_t before = __atomic_load_n(&shared->sequence, __ATOMIC_ACQUIRE);
        if (before == 0) return 0;
        if (before % 2 == 0) {
            for (i = 0; i < sizeof *copy; ++i) ((char*)copy)[i] = ((const volatile char*)shared)[i];
            __atomic_thread_fence(__ATOMIC_ACQUIRE);
            if (__atomic_load_n(&shared->sequence, __ATOMIC_RELAXED) == before) return 1;
        }
    }
    return 0;
}

#ifdef __cplusplus
}
#endif

#endif
