/* A host in C99: feeds a bone and a mesh frame by frame, looks at what comes out, cancels, and reads what is wrong.
 * SPDX-License-Identifier: GPL-3.0-or-later */
#include "sinew.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures = 0;

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            ++failures;                                                                                                \
            printf("%s:%d: %s\n%s", __FILE__, __LINE__, #condition, sinew_error_text());                               \
        }                                                                                                              \
    } while (0)

/* A ball of 2 units that hangs on a plate; the plate follows a matrix. Beside it stands a bone whose mesh is sent. */
static const char graph[] =
    "{\"format\": \"sinew 1\", \"timing\": {\"fps\": 24, \"start\": 1, \"end\": 20}, \"nodes\": {\n"
    "\"cube\": {\"type\": \"polyCube\", \"inputs\": {\"width\": 6, \"height\": 1, \"depth\": 6}},\n"
    "\"move\": {\"type\": \"transform\"},\n"
    "\"plate\": {\"type\": \"zBone\", \"inputs\": {\"mesh\": {\"from\": \"cube.outMesh\"},"
    " \"matrix\": {\"from\": \"move.outMatrix\"}}},\n"
    "\"sent\": {\"type\": \"hostMesh\"},\n"
    "\"post\": {\"type\": \"zBone\", \"inputs\": {\"mesh\": {\"from\": \"sent.outMesh\"}}},\n"
    "\"ball\": {\"type\": \"polySphere\", \"inputs\": {\"radius\": 2}},\n"
    "\"flesh\": {\"type\": \"zMaterial\"},\n"
    "\"hung\": {\"type\": \"zTissue\", \"inputs\": {\"mesh\": {\"from\": \"ball.outMesh\"},"
    " \"materials\": [{\"from\": \"flesh.outMaterial\"}]}},\n"
    "\"top\": {\"type\": \"weights\", \"inputs\": {\"mesh\": {\"from\": \"ball.outMesh\"}, \"mode\": \"ramp\","
    " \"axis\": \"y\", \"start\": 1, \"end\": 1.8}},\n"
    "\"tie\": {\"type\": \"zAttachment\", \"inputs\": {\"source\": {\"from\": \"hung.outBody\"},"
    " \"target\": {\"from\": \"plate.outBody\"}, \"weights\": {\"from\": \"top.outWeights\"}}},\n"
    "\"solver\": {\"type\": \"zSolver\", \"inputs\": {\"bodies\": [{\"from\": \"plate.outBody\"},"
    " {\"from\": \"hung.outBody\"}, {\"from\": \"post.outBody\"}],"
    " \"attachments\": [{\"from\": \"tie.outAttachment\"}]}}}}";

static sinew_status send_matrix(sinew_session* s, int frame, double lift) {
    double matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    matrix[7] = 2.5 + lift;
    return sinew_set_input(s, "move", "offsetParentMatrix", frame, matrix, 16);
}

static long long simulated(sinew_session* s) {
    sinew_counts counts = SINEW_SIZED(sinew_counts);
    CHECK(sinew_get_counts(s, &counts) == SINEW_OK);
    return counts.simulated;
}

static void send_post(sinew_session* s, int frame, double height) {
    /* Four values a point: the host's own layout. */
    double points[16] = {8, 0, 0, -1, 9, 0, 0, -1, 8, 0, 1, -1, 8, 0, 0, -1};
    static const int32_t faces[12] = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
    sinew_mesh mesh = SINEW_SIZED(sinew_mesh);
    points[13] = height;
    mesh.points = points, mesh.point_count = 4, mesh.point_stride = 32;
    if (frame == 1) mesh.face_vertices = faces, mesh.corner_count = 12;
    CHECK(sinew_set_mesh(s, "sent", frame, &mesh) == SINEW_OK);
}

static void check_frame(sinew_session* s, int frame, double lift, double height) {
    sinew_frame* result = NULL;
    sinew_mesh mesh = SINEW_SIZED(sinew_mesh);
    size_t count = 0, place = 9;
    const char* report = NULL;
    double low = 1e9;
    CHECK(sinew_evaluate(s, NULL, frame, &result) == SINEW_OK);
    CHECK(sinew_mesh_count(result, &count) == SINEW_OK && count == 3);
    CHECK(sinew_find_mesh(result, "plate", &place) == SINEW_OK && place == 0);
    CHECK(sinew_get_mesh(result, 0, &mesh) == SINEW_OK);
    CHECK(strcmp(mesh.name, "plate") == 0);
    CHECK(mesh.point_count == 8 && mesh.face_count == 6 && mesh.corner_count == 24 && mesh.triangle_count == 12);
    CHECK(mesh.point_stride == 3 * sizeof(double));
    for (size_t i = 0; i < mesh.point_count; ++i) low = fmin(low, mesh.points[3 * i + 1]);
    CHECK(low == 2.5 + lift - 0.5);
    CHECK(sinew_find_mesh(result, "post", &place) == SINEW_OK && sinew_get_mesh(result, place, &mesh) == SINEW_OK);
    CHECK(mesh.point_count == 4 && mesh.points[10] == height && mesh.triangle_count == 4);
    CHECK(mesh.triangles[3] == 0 && mesh.triangles[4] == 3 && mesh.face_sizes[1] == 3);
    CHECK(sinew_get_report(result, &report) == SINEW_OK && strstr(report, "\"converged\":true") != NULL);
    CHECK(sinew_release(result) == SINEW_OK);
}

static int stop_at = 0;
static int warnings = 0;

static int on_event(void* user, const sinew_event* event) {
    sinew_session* s = *(sinew_session**)user;
    sinew_frame* result = NULL;
    if (event->kind != SINEW_STEPPED) return 0;
    CHECK(sinew_evaluate(s, NULL, 1, &result) == SINEW_USAGE && result == NULL); /* not in a callback of its own */
    return (int)event->frame == stop_at;
}

static void on_warning(void* user, const sinew_diagnostic* warning) {
    (void)user;
    ++warnings;
    CHECK(strcmp(warning->code, "DG010") == 0 && warning->severity == SINEW_WARNING);
}

static void feed_and_look(void) {
    sinew_session* s = NULL;
    CHECK(sinew_open(NULL, &s) == SINEW_OK);
    CHECK(sinew_load_text(s, graph, strlen(graph), NULL) == SINEW_OK);
    for (int frame = 1; frame <= 6; ++frame) {
        CHECK(send_matrix(s, frame, 0.01 * frame) == SINEW_OK);
        send_post(s, frame, 1 + 0.1 * frame);
        check_frame(s, frame, 0.01 * frame, 1 + 0.1 * frame);
        CHECK(simulated(s) == frame);
    }
    check_frame(s, 3, 0.03, 1 + 0.1 * 3);
    CHECK(send_matrix(s, 6, 0.06) == SINEW_OK); /* the same again */
    check_frame(s, 6, 0.06, 1 + 0.1 * 6);
    CHECK(simulated(s) == 6);
    CHECK(send_matrix(s, 5, 0.3) == SINEW_OK); /* another one: frames 5 and 6 anew */
    check_frame(s, 6, 0.06, 1 + 0.1 * 6);
    CHECK(simulated(s) == 8);
    CHECK(sinew_close(s) == SINEW_OK);
}

static void cancel_and_go_on(void) {
    sinew_session* s = NULL;
    sinew_options options = SINEW_SIZED(sinew_options);
    sinew_frame* result = NULL;
    int ready = 7;
    options.threads = 2, options.on_event = on_event, options.user = &s;
    stop_at = 4;
    CHECK(sinew_open(&options, &s) == SINEW_OK);
    CHECK(sinew_load_text(s, graph, strlen(graph), "host.json") == SINEW_OK);
    send_post(s, 1, 1);
    CHECK(sinew_evaluate(s, "solver.outMeshes", 9, &result) == SINEW_CANCELLED && result == NULL);
    CHECK(sinew_error_count() == 0);
    CHECK(simulated(s) == 4);
    CHECK(sinew_is_ready(s, NULL, 3, &ready) == SINEW_OK && ready == 1);
    CHECK(sinew_is_ready(s, NULL, 9, &ready) == SINEW_OK && ready == 0);
    stop_at = 0;
    CHECK(sinew_evaluate(s, "solver.outMeshes", 9, &result) == SINEW_OK);
    CHECK(simulated(s) == 9);
    CHECK(sinew_close(s) == SINEW_OK);
    CHECK(sinew_release(result) == SINEW_OK);
}

static void read_what_is_wrong(void) {
    static const char wrong[] = "{\"format\": \"sinew 1\", \"nodes\": {\n \"a\": {\"type\": \"polyCube\",\n"
                                "  \"inputs\": {\"widht\": 3}},\n \"b\": {\"type\": \"zTissue\"}}}";
    static const char unknown[] = "{\"format\": \"sinew 1\", \"nodes\": {\"a\": {\"type\": \"polyCubes\"}}}";
    sinew_session* s = NULL;
    sinew_options options = SINEW_SIZED(sinew_options);
    sinew_diagnostic d = SINEW_SIZED(sinew_diagnostic);
    options.on_warning = on_warning;
    CHECK(sinew_open(&options, &s) == SINEW_OK);
    CHECK(sinew_load_text(s, wrong, strlen(wrong), "wrong.json") == SINEW_GRAPH_WRONG);
    CHECK(sinew_error_count() == 2); /* and a tissue without a mesh */
    CHECK(sinew_error(0, &d) == SINEW_OK);
    CHECK(strcmp(d.code, "DG011") == 0 && strcmp(d.node, "a") == 0 && strcmp(d.attribute, "widht") == 0);
    CHECK(strcmp(d.file, "wrong.json") == 0 && d.line == 3 && d.column == 14);
    CHECK(strcmp(d.pointer, "/nodes/a/inputs/widht") == 0 && strstr(d.hint, "width") != NULL);
    CHECK(d.severity == SINEW_ERROR && d.has_frame == 0);
    CHECK(sinew_error(2, &d) == SINEW_USAGE && sinew_error_count() == 2);
    CHECK(sinew_load_text(s, unknown, strlen(unknown), NULL) == SINEW_OK && warnings == 1);
    CHECK(sinew_error_count() == 0 && sinew_error_text()[0] == 0);
    CHECK(sinew_load_file(s, "/there/is/none.json") == SINEW_GRAPH_WRONG);
    CHECK(sinew_error(0, &d) == SINEW_OK && strcmp(d.code, "IO401") == 0);
    CHECK(sinew_close(s) == SINEW_OK);
}

static void values_and_numbers(void) {
    static const char text[] =
        "{\"format\": \"sinew 1\", \"timing\": {\"fps\": 30, \"start\": 2, \"end\": 5}, \"nodes\": {"
        "\"cube\": {\"type\": \"polyCube\"}, \"paint\": {\"type\": \"weights\", \"inputs\": {"
        "\"mesh\": {\"from\": \"cube.outMesh\"}, \"value\": 0.25}}, \"turn\": {\"type\": \"transform\"}}}";
    const double three[3] = {1, 2, 4}, two[2] = {1, 2}, one = 0.5;
    const double* numbers = NULL;
    size_t count = 0;
    sinew_session* s = NULL;
    sinew_frame* result = NULL;
    sinew_mesh mesh = SINEW_SIZED(sinew_mesh);
    sinew_timing timing = SINEW_SIZED(sinew_timing);
    sinew_input inputs[2] = {SINEW_SIZED(sinew_input), SINEW_SIZED(sinew_input)};
    CHECK(sinew_open(NULL, &s) == SINEW_OK);
    CHECK(sinew_load_text(s, text, strlen(text), NULL) == SINEW_OK);
    CHECK(sinew_get_timing(s, &timing) == SINEW_OK && timing.fps == 30 && timing.start == 2 && timing.end == 5);
    CHECK(sinew_evaluate(s, "paint.outWeights", 1, &result) == SINEW_OK);
    CHECK(sinew_get_numbers(result, &numbers, &count) == SINEW_OK && count == 8 && numbers[7] == 0.25);
    CHECK(sinew_get_mesh(result, 0, &mesh) == SINEW_USAGE);
    CHECK(sinew_release(result) == SINEW_OK);
    CHECK(sinew_set_numbers(s, "paint", "value", &one, 1) == SINEW_OK);
    CHECK(sinew_set_text(s, "cube", "comment", "no such input") == SINEW_USAGE);
    CHECK(sinew_set_numbers(s, "turn", "translate", two, 2) == SINEW_USAGE);
    CHECK(sinew_set_json(s, "turn", "scale", "[2, 2, 2]") == SINEW_OK);
    inputs[0].node = "turn", inputs[0].attribute = "translate", inputs[0].numbers = three, inputs[0].count = 3;
    inputs[1].node = "turn", inputs[1].attribute = "rotateOrder", inputs[1].text = "zyx";
    CHECK(sinew_set_inputs(s, 3, inputs, 2) == SINEW_OK);
    CHECK(sinew_evaluate(s, "turn.outMatrix", 3, &result) == SINEW_OK);
    CHECK(sinew_get_numbers(result, &numbers, &count) == SINEW_OK && count == 16);
    CHECK(numbers[3] == 1 && numbers[7] == 2 && numbers[11] == 4 && numbers[0] == 2 && numbers[15] == 1);
    CHECK(sinew_release(result) == SINEW_OK);
    inputs[1].text = "zzz"; /* all or none */
    inputs[0].numbers = two, inputs[0].count = 1, inputs[0].attribute = "trackOffset";
    CHECK(sinew_set_inputs(s, 4, inputs, 2) == SINEW_GRAPH_WRONG);
    CHECK(sinew_evaluate(s, "paint.outWeights", 1, &result) == SINEW_OK);
    CHECK(sinew_get_numbers(result, &numbers, &count) == SINEW_OK && numbers[0] == 0.5);
    CHECK(sinew_release(result) == SINEW_OK);
    CHECK(sinew_close(s) == SINEW_OK);
}

int main(void) {
    CHECK(sinew_abi_version() == SINEW_ABI_VERSION);
    CHECK(strcmp(sinew_version(), "0.1.0") == 0);
    feed_and_look();
    cancel_and_go_on();
    read_what_is_wrong();
    values_and_numbers();
    if (failures == 0) printf("all well\n");
    return failures != 0;
}
