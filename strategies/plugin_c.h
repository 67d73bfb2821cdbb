/* Strategies out of the tree, in C: what a shared library exports that `servomill --plugin FILE`
 * or `plugins = ["FILE"]` loads. strategies/README.md, "Strategies out of the tree".
 *
 * All lengths are in m, angles in rad, times in s. Joints are X, Y, Z and the (at most two) rotary
 * axes in alphabetical order; the place of an axis that the machine lacks holds 0.
 *
 * Every struct begins with its size in bytes, as the side knows it that has filled it in. While
 * SERVOMILL_PLUGIN_ABI stays the same, members are only ever appended:
 * - a library that was built with earlier headers is read as far as it goes; functions that it
 *   lacks are NULL;
 * - one of later headers is taken if it uses nothing that this program lacks;
 * - a member of a reading or setup that was appended after the first headers may be read only if
 *   `size` reaches beyond it: SERVOMILL_HAS(reading, Q_cmd).
 * A library of another SERVOMILL_PLUGIN_ABI is refused. */
#ifndef SERVOMILL_STRATEGIES_PLUGIN_C_H
#define SERVOMILL_STRATEGIES_PLUGIN_C_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SERVOMILL_PLUGIN_ABI 1u
#define SERVOMILL_JOINTS 5

/* Whether the struct behind a pointer goes as far as a member. */
#define SERVOMILL_HAS(pointer, member) \
  ((pointer)->size >= (size_t)((const char*)(&(pointer)->member + 1) - (const char*)(pointer)))

/* What a strategy may see of a run at one instant. */
typedef struct servomill_reading {
  size_t size;
  double t;                         /* s, since the start of the program */
  double s;                         /* m, arc length on the path of the original program */
  double Q_ref[SERVOMILL_JOINTS];   /* as the NC interpolated it last */
  double dQ_ref[SERVOMILL_JOINTS];  /* per s */
  double ddQ_ref[SERVOMILL_JOINTS]; /* per s^2 */
  double Q_fb[SERVOMILL_JOINTS];    /* `displacement`: the scales; else what the loops read */
  const double* sensors;            /* further readings; none so far */
  size_t sensor_count;
  double Q_cmd[SERVOMILL_JOINTS]; /* what the position loops followed last, with all offsets */
} servomill_reading;

/* A key of [[case.strategy]]. */
typedef struct servomill_parameter {
  size_t size;
  const char* name;         /* with its unit suffix: "time_constant_ms" */
  const char* help;         /* one line */
  const char* unit;         /* of a bare number: "ms"; "" is dimensionless */
  const char* default_text; /* as the user would write it; "": required */
  double min, max;          /* inclusive, in `unit` */
} servomill_parameter;

/* What one run of a strategy is made from. */
typedef struct servomill_setup {
  size_t size;
  const double* parameters; /* in SI, in the order of servomill_strategy.parameters */
  size_t parameter_count;
  double period;                  /* s, between two calls; NaN: not known (`offset`, `rewrite`) */
  double lower[SERVOMILL_JOINTS]; /* travel of the machine */
  double upper[SERVOMILL_JOINTS];
  char axes[SERVOMILL_JOINTS]; /* letter of each joint; 0: the machine has none there */
  double sign;                 /* knows_errors: +1 imposes the errors, -1 compensates them */
  /* knows_errors: displacement (3) of the tool centre point along X, Y and Z that the identified
   * errors cause at Q; else NaN. For any thread, as long as the run. */
  const void* model;
  void (*error_at)(const void* model, const double Q[SERVOMILL_JOINTS], double error[3]);
} servomill_setup;

/* A motion of the program, from where the one before has ended. Positions are those of the axes, in
 * machine coordinates. */
enum { SERVOMILL_RAPID = 0, SERVOMILL_LINE = 1, SERVOMILL_ARC = 2 };
typedef struct servomill_move {
  size_t size;
  int32_t kind; /* one of these; SERVOMILL_ARC is any curve: its way is that of position() */
  int32_t line; /* of the program */
  double end[SERVOMILL_JOINTS];
  double s_begin, s_end; /* m, arc length on the path of the original program */
  double feed;           /* m/s; rad/s where X, Y and Z stand still; 0: rapid */
} servomill_move;

/* A straight block in place of a motion, or of a part of it. Line, arc length and mode of the feed
 * are those of the motion. */
typedef struct servomill_block {
  size_t size;
  size_t move;  /* number of the motion, from 0 */
  double share; /* of the motion, at which the block ends: rising, and 1 for the last one */
  double end[SERVOMILL_JOINTS];
  double feed_factor; /* 1: as programmed */
} servomill_block;

/* The program, for the time of `rewrite`. */
typedef struct servomill_program {
  size_t size;
  const servomill_move* const* moves;
  size_t move_count;
  double start[SERVOMILL_JOINTS];
  void* host; /* the first argument of these functions */
  /* Programmed position at a share (0 to 1) of a motion, of arcs too. NaN: there is none. */
  void (*position)(const void* host, size_t move, double share, double Q[SERVOMILL_JOINTS]);
  /* Adds a block, in the order of the motions. A motion without blocks stays as it is. */
  void (*add_block)(void* host, const servomill_block* block);
} servomill_program;

/* One strategy. Functions that return text return NULL where all is well, else why not: the case
 * ends with that message. The text is copied before the next call. What they write must be finite;
 * a case whose strategy writes anything else ends. Runs go on in several threads at once; those of
 * one state never do. */
typedef struct servomill_strategy {
  size_t size;
  const char* name;    /* lower case and '_' */
  const char* summary; /* one line */
  const servomill_parameter* const* parameters;
  size_t parameter_count;
  int knows_errors;     /* takes the keys model and action */
  int displaces_rotary; /* `displacement` and `rewrite` may displace rotary axes */

  /* State of one run. */
  const char* (*create)(const servomill_setup* setup, void** state);
  void (*destroy)(void* state); /* may be NULL */

  /* Has stood for long at reading->Q_fb (or Q_ref): to begin anew. May be NULL. */
  const char* (*settle)(void* state, const servomill_reading* reading);
  /* Virtual displacement: what is added to the reading of the scales, so that the axis moves by its
   * negative; once per model period of the feedback hardware, acts one period later. Or NULL. */
  const char* (*displacement)(void* state, const servomill_reading* reading,
                              double d[SERVOMILL_JOINTS]);
  /* Offset of the setpoint behind the feed-forward tap; once per position period. Or NULL. */
  const char* (*offset)(void* state, const servomill_reading* reading,
                        double offset[SERVOMILL_JOINTS]);
  /* Rewrites the program before the run, by a state of its own, whose period is NaN. Or
   * NULL. X, Y and Z of a motion of rotary axes alone stay where the block before has ended. */
  const char* (*rewrite)(void* state, const servomill_program* program);
  /* Adds to the velocity commands (m/s, rad/s) in the position loops, once per position period,
   * with Q_cmd and Q_fb of this one: v_cmd = Kv (Q_cmd - Q_fb) + kvf dQ_ref + velocity. Or NULL.
   * Ten times the v_max of an axis ends the case. */
  const char* (*position_loop)(void* state, const servomill_reading* reading,
                               double velocity[SERVOMILL_JOINTS]);
} servomill_strategy;

typedef struct servomill_plugin_c {
  uint32_t abi; /* SERVOMILL_PLUGIN_ABI */
  uint32_t reserved;
  size_t size;
  const char* name;
  const char* version;
  const servomill_strategy* const* strategies;
  size_t strategy_count;
} servomill_plugin_c;

/* The one symbol that a library in C exports:
 *   const servomill_plugin_c* servomill_plugin_c_entry(void);                                    */
typedef const servomill_plugin_c* (*servomill_plugin_c_function)(void);
#define SERVOMILL_PLUGIN_C_ENTRY "servomill_plugin_c_entry"

#ifdef __cplusplus
}
#endif

#endif
