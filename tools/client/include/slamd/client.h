/* The C interface of libslamd, the client of slamd's socket and pose page. Stable: within libslamd.so.0 functions are added,
 * none changes or goes away, and no struct changes. It is no C++ header (client.hpp) and no part of the daemon.
 *
 * Functions that can fail return SLAMD_OK or why they failed; slamd_last_error() has the words. Texts are UTF-8. What the
 * methods and their JSON mean is in docs/protocol.md. */
#ifndef SLAMD_CLIENT_H
#define SLAMD_CLIENT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Negative codes are the daemon's own answers, as docs/protocol.md numbers them. */
enum {
  SLAMD_OK = 0,
  SLAMD_NO_CONNECTION = 1, /* nobody listens, no permission, or the daemon has hung up */
  SLAMD_TIMEOUT = 2,       /* no answer within the connection's patience */
  SLAMD_PROTOCOL = 3,      /* what came is not what the protocol says */
  SLAMD_USAGE = 4,         /* an argument of the caller is wrong */
  SLAMD_SYSTEM = 5         /* memory, files; slamd_last_error() has the system's reason */
};

enum { SLAMD_INITIALISING = 0, SLAMD_TRACKING = 1, SLAMD_DEGRADED = 2, SLAMD_LOST = 3 };

#define SLAMD_UTC_OFFSET_UNKNOWN INT64_MIN

/* All that the daemon says of one instant. SI units; quaternions are x, y, z, w. */
typedef struct slamd_pose {
  int64_t host_time_ns;           /* CLOCK_MONOTONIC of the instant described */
  int64_t utc_offset_ns;          /* UTC since 1970 = host_time_ns + utc_offset_ns; or SLAMD_UTC_OFFSET_UNKNOWN */
  uint64_t sequence;              /* counts poses from 1, without gaps */
  double map_position_m[3];       /* of base in map; may jump when the map is corrected */
  double map_rotation_xyzw[4];
  double odom_position_m[3];      /* of base in odom; never jumps */
  double odom_rotation_xyzw[4];
  double velocity_mps[3];         /* of base, in odom */
  double angular_velocity_rads[3]; /* of base, in base */
  double covariance[36];          /* of the odom pose, row-major: position in odom, then attitude as right perturbation */
  double degenerate_direction[3]; /* unit, odom; zero when all directions are constrained */
  uint32_t status;                /* SLAMD_INITIALISING ... */
  uint32_t reasons;               /* bits, see slamd_reason_name() */
  float lidar_test_ratio;         /* > 1: the newest scan was rejected */
  uint32_t map_corrections;       /* counts changes of map relative to odom */
} slamd_pose;

/* One connection; one thread at a time. */
typedef struct slamd_connection slamd_connection;

/* Shared memory with the newest pose; any thread. */
typedef struct slamd_page slamd_page;

/* Told of a request's progress, as JSON; must not throw and not use the connection. */
typedef void (*slamd_progress_fn)(void* user, const char* params_json);
typedef void (*slamd_bytes_fn)(void* user, size_t bytes);

typedef struct slamd_request {
  const char* method;
  const char* params_json;       /* an object; NULL: none */
  slamd_progress_fn on_progress; /* NULL: progress waits for slamd_next() like all notifications */
  void* user;                    /* for on_progress */
} slamd_request;

typedef struct slamd_answer {
  const char* result_json; /* good until the next function of this connection is called */
  int fd;                  /* the descriptor that came with it, the caller's to close; -1: none */
} slamd_answer;

/* Why the newest function of this thread that failed did so; "" when none has. Good until the next failure. */
const char* slamd_last_error(void);

/* Connects and agrees on the protocol's version. socket_path NULL: /run/slamd/slamd.sock. timeout_ms: how long calls wait for
 * the daemon, their patience. On success *connection is to be given to slamd_disconnect(), which takes NULL too. */
int slamd_connect(const char* socket_path, int timeout_ms, slamd_connection** connection);
void slamd_disconnect(slamd_connection* connection);

/* The daemon's answer to "version", as JSON; good as long as the connection. */
const char* slamd_version(const slamd_connection* connection);

/* One request and its answer. Notifications that come meanwhile wait for slamd_next(). */
int slamd_call(slamd_connection* connection, const slamd_request* request, slamd_answer* answer);

/* topic "pose", "status" or "grid". The newest 10,000 notifications that nobody took are kept. */
int slamd_subscribe(slamd_connection* connection, const char* topic, double rate_hz);
int slamd_unsubscribe(slamd_connection* connection, const char* topic);

/* The oldest notification not yet taken, whatever its topic; waits for one. Both texts are good until the next function. */
int slamd_next(slamd_connection* connection, const char** topic, const char** params_json);

/* The oldest pose not yet taken; waits for one. Needs slamd_subscribe(connection, "pose", ...). Others stay for slamd_next(). */
int slamd_next_pose(slamd_connection* connection, slamd_pose* pose);

/* Maps the pose page; it stays readable after the connection has gone. To be given to slamd_close_page(). */
int slamd_open_page(slamd_connection* connection, slamd_page** page);
void slamd_close_page(slamd_page* page);

/* The newest pose, without a system call, below 100 ns. Returns 1; 0 before the daemon's first pose, and when it died in the
 * middle of a write. A page that no longer changes is a daemon that has gone: compare host_time_ns with CLOCK_MONOTONIC. */
int slamd_read_page(const slamd_page* page, slamd_pose* pose);

/* How many daemons have written this page. After a change odom and map begin anew, and sequence counts from 1. */
uint32_t slamd_page_starts(const slamd_page* page);

/* The names that the protocol uses: of a status ("TRACKING"), of one bit of the reasons ("no_imu"); "?" for those of a later
 * daemon. */
const char* slamd_status_name(uint32_t status);
const char* slamd_reason_name(uint32_t bit);

/* Copies all of a descriptor's content to a file, by way of a temporary one beside it that is then renamed. on_bytes, which may
 * be NULL, is told how much is written. */
int slamd_save_fd(int fd, const char* path, slamd_bytes_fn on_bytes, void* user);

#ifdef __cplusplus
}
#endif

#endif
