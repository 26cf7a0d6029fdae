// SPDX-License-Identifier: GPL-3.0-or-later
/* Sinew for C: soft tissue that moves by the laws of physics, from a graph file, frame by frame.
 *
 * Handles are opaque. They are numbers in the clothes of pointers: nothing is at their address, and one that was
 * released, or never was one, is refused (DG120), not followed.
 *
 * Functions that can fail give a sinew_status, and nothing is thrown. What went wrong is in the errors of the calling
 * thread (sinew_error_count, sinew_error) until its next call of such a function.
 *
 * Threads: every function may be called from any thread. Edits of a session come one after the other; evaluations run
 * side by side, and each sees the graph as it was when it began. Callbacks come from worker threads, one at a time a
 * session; in one, of that session only sinew_cancel and sinew_get_counts may be called (else SINEW_USAGE, DG140).
 *
 * Structures begin with their size, which the caller sets (SINEW_SIZED): programs built with an older header keep
 * working with a newer library, which leaves alone what they do not know. Within one number of SINEW_ABI_VERSION
 * functions and fields are only added.
 *
 * Numbers: lengths in the scene's unit, all else as the node reference says. Matrices are 4 by 4, row by row, for
 * column vectors: the translation is in numbers 3, 7 and 11.
 */
#ifndef SINEW_H
#define SINEW_H

#include <stddef.h>
#include <stdint.h>

#define SINEW_API __attribute__((visibility("default")))
#define SINEW_ABI_VERSION 1

/* An initialiser: `sinew_mesh mesh = SINEW_SIZED(sinew_mesh);`, all else zero. */
#ifdef __cplusplus
template <class T>
inline T sinew_sized() {
    T out{};
    out.size = sizeof(T);
    return out;
}
#define SINEW_SIZED(type) sinew_sized<type>()
#else
#define SINEW_SIZED(type)                                                                                              \
    { .size = sizeof(type) }
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef struct sinew_session sinew_session; /* a graph, and what has been computed of it */
typedef struct sinew_frame sinew_frame;     /* what one evaluation gave */

/* The numbers are those of the program's exit codes. */
typedef enum sinew_status {
    SINEW_OK = 0,
    SINEW_GRAPH_WRONG = 1,  /* the graph, a mesh or a value in it */
    SINEW_USAGE = 2,        /* the call: a handle, an argument, a name; the calling program is to be repaired */
    SINEW_SOLVE_FAILED = 3, /* the graph is right, but a simulation could not go on */
    SINEW_CANCELLED = 4,    /* the host asked for it; finished frames stay */
    SINEW_INTERNAL = 5      /* an error in Sinew */
} sinew_status;

/* "0.1.0" */
SINEW_API const char* sinew_version(void);
/* SINEW_ABI_VERSION of the library; a program refuses to run with another one than that of its header. */
SINEW_API uint32_t sinew_abi_version(void);

/* ---- what went wrong ---- */

typedef enum sinew_severity { SINEW_NOTE = 0, SINEW_WARNING = 1, SINEW_ERROR = 2 } sinew_severity;

/* Texts are never null; "" where there is nothing to say. */
typedef struct sinew_diagnostic {
    size_t size;
    sinew_severity severity;
    const char* code;      /* stable, docs/reference/codes.md: "DG013" */
    const char* node;      /* of the graph */
    const char* attribute; /* of that node */
    const char* file;      /* place in the graph file */
    const char* pointer;   /* the same as a JSON pointer */
    int line, column;      /* from 1; 0: unknown */
    int has_frame;         /* whether `frame` says when */
    double frame;
    const char* message; /* what is wrong */
    const char* hint;    /* what would be right */
} sinew_diagnostic;

/* Errors of the last call of this thread that could fail; 0 after SINEW_OK. */
SINEW_API size_t sinew_error_count(void);
/* Its texts are valid until that thread's next call that can fail. SINEW_USAGE for an index out of range; this
 * function leaves the errors as they are. */
SINEW_API sinew_status sinew_error(size_t index, sinew_diagnostic* out);
/* All of them for people, a line each and more; "" if there is none. Valid as long. */
SINEW_API const char* sinew_error_text(void);

/* ---- sessions ---- */

typedef enum sinew_event_kind {
    SINEW_PROGRESS = 0, /* within a node or step: `done` of 1, doing `what` */
    SINEW_STEPPED = 1,  /* a simulation has a further frame */
    SINEW_COMPUTED = 2, /* another node ran */
    SINEW_REUSED = 3    /* a result was there already */
} sinew_event_kind;

typedef struct sinew_event {
    size_t size;
    sinew_event_kind kind;
    const char* node; /* texts are valid during the callback */
    double frame;     /* of SINEW_PROGRESS: not told, 0 */
    double seconds;   /* what a step or node took */
    double done;      /* 0 to 1 */
    const char* what;
} sinew_event;

typedef struct sinew_options {
    size_t size;
    int32_t threads;          /* 0: all of the machine */
    uint64_t memory_bytes;    /* for results that are kept; 0: a quarter of the machine's memory */
    const char* cache_folder; /* frames are kept there for later processes; null: nowhere */
    uint64_t cache_bytes;     /* what they may take; 0: 10 GiB */
    /* Tells what goes on. Another result than 0 cancels all evaluations of the session that run. May be null. */
    int (*on_event)(void* user, const sinew_event* event);
    /* Tells of what is doubtful and did not stop anything. May be null. */
    void (*on_warning)(void* user, const sinew_diagnostic* warning);
    void* user; /* handed to both */
    /* The only folder in which files are opened and written that graphs and the host name, wherever "..", absolute
     * paths and links lead; null: anywhere. */
    const char* root_folder;
} sinew_options;

/* options: null for none. *out is null after a failure. */
SINEW_API sinew_status sinew_open(const sinew_options* options, sinew_session** out);
/* The handle is dead at once; calls that run on it end well. Frames live on. Null is allowed. */
SINEW_API sinew_status sinew_close(sinew_session* session);

/* In place of the graph before. What has been computed stays and is found again where it fits. */
SINEW_API sinew_status sinew_load_file(sinew_session* session, const char* path);
/* text: a graph file, `length` bytes. file_name stands in messages, and relative paths in the graph start at its
 * folder; null: the current folder. */
SINEW_API sinew_status sinew_load_text(sinew_session* session, const char* text, size_t length, const char* file_name);

typedef struct sinew_timing {
    size_t size;
    double fps;
    int32_t start, end;
} sinew_timing;
SINEW_API sinew_status sinew_get_timing(sinew_session* session, sinew_timing* out);

/* ---- values ---- */

/* What a graph file holds at an input, as JSON: a literal, {"value", "unit"}, {"keys"}, {"from"}, a list of those. */
SINEW_API sinew_status sinew_set_json(sinew_session* session, const char* node, const char* attribute,
                                      const char* json);
/* At all frames alike. One number is a switch, a whole number or a number; three are a vector, 16 a matrix; an input
 * that takes a list takes any count. */
SINEW_API sinew_status sinew_set_numbers(sinew_session* session, const char* node, const char* attribute,
                                         const double* numbers, size_t count);
/* A word, a text, the path of a file, or a number with its unit ("30 kPa"). */
SINEW_API sinew_status sinew_set_text(sinew_session* session, const char* node, const char* attribute,
                                      const char* text);

/* What a host sends at a frame: numbers as above, or a word of an input that has options. */
typedef struct sinew_input {
    size_t size;
    const char *node, *attribute;
    const double* numbers; /* null where `text` is given */
    size_t count;
    const char* text;
} sinew_input;

/* From `frame` on, until another frame is sent; up to the whole frame before, everything stays as it is, to the bit, so
 * simulations go on from there. All of them or none. Sub-steps between two frames interpolate. The same values sent
 * again find the same frames. */
SINEW_API sinew_status sinew_set_inputs(sinew_session* session, double frame, const sinew_input* inputs, size_t count);
/* The same for one input of numbers. */
SINEW_API sinew_status sinew_set_input(sinew_session* session, const char* node, const char* attribute, double frame,
                                       const double* numbers, size_t count);

/* A surface. Given out: points as x, y, z, triangles as three vertices. */
typedef struct sinew_mesh {
    size_t size;
    const char* name;     /* the node whose body it is; "" if it is nobody's */
    const double* points; /* in scene units */
    size_t point_count;
    size_t point_stride;       /* bytes from one point to the next */
    const int32_t* face_sizes; /* corners of each face */
    size_t face_count;
    const int32_t* face_vertices; /* corners, face after face */
    size_t corner_count;
    const int32_t* triangles; /* the faces, cut */
    size_t triangle_count;
} sinew_mesh;

/* Sends a mesh to a hostMesh node, from `frame` on; the first one holds for the frames before, too. Read: points (a
 * stride of 0 is 24 bytes), and the faces as face_sizes and face_vertices (without face_sizes: triangles); without
 * face_vertices the faces stay. Other faces than before make another mesh, for all frames. Faces with corners that are
 * none of the points are refused (SINEW_USAGE), and what was sent before stays. Copied. */
SINEW_API sinew_status sinew_set_mesh(sinew_session* session, const char* node, double frame, const sinew_mesh* mesh);

/* ---- evaluation ---- */

/* plug: "node.output"; null: outMeshes of the solver that no other one reads. Only what is not there yet runs; it can
 * be millions of operations or none. *out is null after a failure. */
SINEW_API sinew_status sinew_evaluate(sinew_session* session, const char* plug, double frame, sinew_frame** out);
/* *out: 1 if that would be a look-up, else 0. Runs nothing. */
SINEW_API sinew_status sinew_is_ready(sinew_session* session, const char* plug, double frame, int* out);
/* Stops the evaluations of the session that are running now; they give SINEW_CANCELLED. */
SINEW_API sinew_status sinew_cancel(sinew_session* session);

typedef struct sinew_counts {
    size_t size;
    int64_t simulated; /* steps of simulations, start frames among them */
    int64_t computed;  /* other nodes that ran */
    int64_t reused;    /* results that were there */
} sinew_counts;
/* Since the session began. */
SINEW_API sinew_status sinew_get_counts(sinew_session* session, sinew_counts* out);

/* ---- results: all pointers are valid until sinew_release ---- */

SINEW_API sinew_status sinew_mesh_count(sinew_frame* frame, size_t* out);
/* The place of the mesh of that node; DG122 if there is none. */
SINEW_API sinew_status sinew_find_mesh(sinew_frame* frame, const char* name, size_t* out);
/* Without copies. */
SINEW_API sinew_status sinew_get_mesh(sinew_frame* frame, size_t index, sinew_mesh* out);
/* Of an output that is a number, vector, matrix or list of numbers. Without a copy where it is a list. */
SINEW_API sinew_status sinew_get_numbers(sinew_frame* frame, const double** numbers, size_t* count);
/* The solver's report of the frame as JSON, docs/concepts/report.md; "{}" where no solver is involved. */
SINEW_API sinew_status sinew_get_report(sinew_frame* frame, const char** json);
/* Null is allowed. */
SINEW_API sinew_status sinew_release(sinew_frame* frame);

#ifdef __cplusplus
}
#endif

#endif
