/* Four intersections of a circle and a hyperbola, then the postures of an arm for one pose:
 *
 *   cc example.c -I. -Llib -lcognate -o example && LD_LIBRARY_PATH=lib ./example
 */
#include "cognate.h"
#include <stdio.h>

static const char *const ARM =
    "theta,d,a,alpha,type\n0,0.2,0,90,revolute\n0,0,0.5,0,revolute\n0,0,0.4,0,revolute\n"
    "0,0.1,0,90,revolute\n0,0.1,0,-90,revolute\n0,0.08,0,0,revolute\n";

static const double POSE[16] = {0, 0, 1, 0.4, 1, 0, 0, 0.3, 0, 1, 0, 0.35, 0, 0, 0, 1};

enum { MOST_POSTURES = 16, DEGREES_OF_A_TURN = 360 };

static int solve(void) {
  char *answer = NULL;
  int code = cognate_solve("x^2 + y^2 = 5\nx*y = 2\n", "[\"--certify\"]", &answer);
  printf("%s\n", answer);
  cognate_free(answer);
  return code;
}

static int postures(void) {
  char *error = NULL;
  cognate_arm *arm = cognate_arm_open(ARM, NULL, &error);
  if (arm == NULL) {
    fprintf(stderr, "%s\n", error);
    cognate_free(error);
    return 2;
  }
  double joints[MOST_POSTURES * 6];
  size_t offsets[2];
  int code = cognate_arm_inverse(arm, POSE, 1, joints, MOST_POSTURES, offsets, NULL, &error);
  if (error != NULL) {
    fprintf(stderr, "%s\n", error);
    cognate_free(error);
  }
  for (size_t posture = 0; posture < offsets[1] && code < 2; posture++) {
    for (size_t joint = 0; joint < 6; joint++) {
      double degrees = joints[6 * posture + joint] * (DEGREES_OF_A_TURN / 6.283185307179586);
      printf("%9.3f", degrees);
    }
    printf("\n");
  }
  cognate_arm_close(arm);
  return code;
}

int main(void) {
  int solved = solve();
  int answered = postures();
  return solved > answered ? solved : answered;
}
