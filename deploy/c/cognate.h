/* libcognate: all solutions of polynomial systems, all postures of arms, in the process of the caller.
 *
 * Texts are UTF-8 and end with a zero byte. Every function may be called from several threads at once. No function
 * starts a process, catches a signal or prints. An answer that a function writes to `*answer` or `*error` belongs to
 * the caller, who gives it back to cognate_free.
 *
 * Every int that a function returns is an exit code of the command `cognate`:
 *   0    settled: every path is accounted for and all counts agree
 *   1    something is in doubt; the answer names it
 *   2    bad input; the answer says where and what was expected
 *   3    given up; the answer says why
 */
#ifndef COGNATE_H
#define COGNATE_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of the library, such as "0.1.0". It is not given back. */
const char *cognate_version(void);

/* All isolated solutions of a system.
 *
 * system:  equations, one a line, such as "x^2 + y^2 = 5\nx*y = 2", or the content of a file in another format that
 *          `cognate solve` reads.
 * options: a JSON array of options as they are typed behind `cognate solve`, such as "[\"--certify\", \"--seed\", \"3\"]";
 *          NULL for none.
 * answer:  {"summary": {...}, "solutions": [...]} with the fields of summary.json and of the lines of solutions.jsonl,
 *          or {"error": "..."}.
 */
int cognate_solve(const char *system, const char *options, char **answer);

/* An arm or another mechanism, read and prepared once. */
typedef struct cognate_arm cognate_arm;

/* Reads a mechanism and prepares it. NULL where that is not possible; the reason is in *error then.
 *
 * mechanism: the content of a file: JSON, TOML, URDF, or a table of Denavit-Hartenberg rows.
 * options:   a JSON array of options as they are typed behind `cognate mechanism serve`, such as
 *            "[\"--lock\", \"q3=0\", \"--within-limits\"]"; NULL for none.
 * error:     a text, or NULL where there is no error. The pointer itself may be NULL.
 */
cognate_arm *cognate_arm_open(const char *mechanism, const char *options, char **error);

/* Gives an arm back. NULL is allowed. */
void cognate_arm_close(cognate_arm *arm);

/* Number of the joints of a posture. */
size_t cognate_arm_joints(const cognate_arm *arm);

/* All real postures for several poses.
 *
 * poses:    count matrices of 4 by 4 numbers by rows.
 * joints:   room for `capacity` postures of cognate_arm_joints(arm) numbers each: radians and lengths, joints in the
 *           order of the file. An arm with six joints has at most 16 postures for a pose.
 * offsets:  room for count + 1 numbers: the postures of pose k are those from offsets[k] to offsets[k + 1] - 1.
 * settled:  room for count bytes: 1 where the answer for the pose is settled, 0 where something is in doubt. NULL is
 *           allowed.
 * error:    a text, or NULL where there is no error. The pointer itself may be NULL.
 *
 * Code 2 where a matrix is no pose, or where there are more than `capacity` postures; offsets[count] is then their
 * number (0 where none was computed), and nothing is written to joints.
 */
int cognate_arm_inverse(const cognate_arm *arm, const double *poses, size_t count, double *joints, size_t capacity,
                        size_t *offsets, uint8_t *settled, char **error);

/* Answers targets, a line of JSON each, as `cognate mechanism serve` does: a pose such as
 * {"position": [0.4, 0.3, 0.35], "quaternion": [0.5, 0.5, 0.5, 0.5]}, or values of the inputs with the option --forward.
 * answer: a line of JSON for each, in the same order.
 */
int cognate_arm_answer(const cognate_arm *arm, const char *lines, char **answer);

/* Gives an answer or an error back. NULL is allowed. */
void cognate_free(char *text);

#ifdef __cplusplus
}
#endif

#endif
