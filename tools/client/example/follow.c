/* Prints ten poses as they come, then the newest one from the pose page.
 *     follow [SOCKET] */
#include <inttypes.h>
#include <slamd/client.h>
#include <stdio.h>

static int told(const char* what) {
  fprintf(stderr, "%s: %s\n", what, slamd_last_error());
  return 1;
}

static void print(const slamd_pose* pose) {
  const double* p = pose->map_position_m;
  printf("%" PRIu64 " %s x %.3f y %.3f z %.3f m\n", pose->sequence, slamd_status_name(pose->status), p[0], p[1], p[2]);
}

static int follow(slamd_connection* daemon) {
  slamd_pose pose;
  slamd_page* page;
  int i;
  if (slamd_subscribe(daemon, "pose", 50.0) != SLAMD_OK) return told("subscribe");
  for (i = 0; i < 10; ++i) {
    if (slamd_next_pose(daemon, &pose) != SLAMD_OK) return told("next pose");
    print(&pose);
  }
  if (slamd_open_page(daemon, &page) != SLAMD_OK) return told("pose page");
  if (slamd_read_page(page, &pose)) print(&pose);
  slamd_close_page(page);
  return 0;
}

int main(int argc, char** argv) {
  slamd_connection* daemon;
  int code;
  if (slamd_connect(argc > 1 ? argv[1] : NULL, 10000, &daemon) != SLAMD_OK) return told("connect");
  code = follow(daemon);
  slamd_disconnect(daemon);
  return code;
}
