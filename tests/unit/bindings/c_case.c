/* A case that is read once in C: what is made of it has the bits of what is made of its text. What
 * is refused besides the arguments of c_bad_calls.c: wrong cases, handles in use. */
#include <stdio.h>
#include <string.h>

#include "rwmf.h"

static const char *text = "&wall h = 2.0, b = 0.5 /\n"
                          "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /\n"
                          "&motion kind = 'record', file = 'record.txt', unit = 'm/s2' /\n"
                          "&impact rule = 'coupled' /\n"
                          "&model formulation = 'exact' /\n"
                          "&solver method = 'dop853', t_end = 3.0 /\n";

static char message[512];
static int failures = 0;

static void expect(int is_true, const char *what) {
   if (is_true) return;
   failures++;
   printf("not so: %s (message: %s)\n", what, message);
}

static void write_file(const char *path, const char *content) {
   FILE *file = fopen(path, "w");
   fputs(content, file);
   fclose(file);
}

/* A call that has to be refused, with a message that holds some words. */
static void refuse(int status, const char *words) {
   expect(status == RWMF_INPUT && strstr(message, words) != NULL, words);
   message[0] = '\0';
}

#define TALK message, sizeof message

static void test_same_bits(void) {
   rwmf_case *scene = NULL, *other = NULL;
   rwmf_result one, two;
   rwmf_wall *wall = NULL;
   rwmf_state before, after;
   rwmf_ending ending;
   rwmf_element *element = NULL;

   expect(rwmf_read_case(text, ".", &scene, TALK) == 0, "reads a text");
   expect(rwmf_read_case_file("./case.nml", &other, TALK) == 0, "reads a file");
   expect(rwmf_run(text, &one, TALK) == 0, "runs a text");
   remove("record.txt");
   expect(rwmf_run_case(scene, &two, TALK) == 0, "runs without the file of the record");
   expect(one.u_s_max == two.u_s_max && one.steps == two.steps, "the bits of the text");
   expect(rwmf_run_case(other, &two, TALK) == 0, "runs a second case");
   expect(rwmf_run_case_ending(scene, &two, &ending, TALK) == 0, "runs and says how it ended");
   expect(ending.t == 3.0 && !ending.overturned && !ending.collapsed, "at its time");
   expect(one.u_s_max == two.u_s_max && one.impacts == two.impacts, "the bits of the file");
   refuse(rwmf_run(text, &two, TALK), "record.txt");

   expect(rwmf_create_from_case(scene, 0, 0, &wall, TALK) == 0, "makes a wall");
   expect(rwmf_create_element_from_case(scene, &element, TALK) == 0, "makes an element");
   rwmf_destroy_case(&scene);
   rwmf_destroy_case(&scene);
   rwmf_destroy_case(NULL);
   expect(rwmf_advance(wall, 1.5, TALK) == 0, "a wall needs its case no more");
   expect(rwmf_query_ending(wall, &ending, TALK) == 0, "a wall says whether it has ended");
   expect(ending.t == 1.5 && !ending.overturned && !ending.collapsed, "it has not");
   expect(rwmf_query_state(wall, &before, TALK) == 0, "state");
   rwmf_destroy(&wall);
   expect(rwmf_create_from_case(other, 0, 0, &wall, TALK) == 0, "another wall");
   expect(rwmf_advance(wall, 1.5, TALK) == 0, "advances");
   expect(rwmf_query_state(wall, &after, TALK) == 0, "its state");
   expect(before.u_s == after.u_s && before.steps == after.steps, "the bits of the first wall");
   expect(rwmf_velocity_factor(element) > 0.9, "an element needs its case no more");
   rwmf_destroy(&wall);
   rwmf_destroy_element(&element);
   rwmf_destroy_case(&other);
}

static void test_bad_calls(void) {
   rwmf_case *scene = NULL;
   rwmf_wall *wall = NULL;
   rwmf_element *element = NULL;

   refuse(rwmf_read_case("&wall h = -1 /", NULL, &scene, TALK), "h = -1");
   refuse(rwmf_read_case(text, "nowhere", &scene, TALK), "nowhere/record.txt");
   refuse(rwmf_read_case_file("missing.nml", &scene, TALK), "missing.nml: the file does not exist");
   expect(scene == NULL, "nothing is made by a call that fails");

   expect(rwmf_read_case_file("case.nml", &scene, TALK) == 0, "reads a file");
   refuse(rwmf_read_case(text, NULL, &scene, TALK), "destroy its case first");
   refuse(rwmf_read_case_file("case.nml", &scene, TALK), "destroy its case first");
   expect(rwmf_create_from_case(scene, 0, 0, &wall, TALK) == 0, "makes a wall");
   refuse(rwmf_create_from_case(scene, 0, 0, &wall, TALK), "destroy its wall first");
   refuse(rwmf_create(text, 0, 0, &wall, TALK), "destroy its wall first");
   expect(rwmf_create_element_from_case(scene, &element, TALK) == 0, "makes an element");
   refuse(rwmf_create_element_from_case(scene, &element, TALK), "destroy its element first");
   rwmf_destroy(&wall);
   rwmf_destroy_element(&element);
   rwmf_destroy_case(&scene);
}

/* Samples in place of the record: the bits of its file, and what is refused. */
static void test_samples(void) {
   double times[] = {0, 0.5, 1, 1.5, 2}, a[] = {0, 4, -4, 3, 0};
   rwmf_samples samples = {5, times, a};
   rwmf_case *scene = NULL;
   rwmf_result one, two;

   expect(rwmf_run(text, &one, TALK) == 0, "runs a file");
   expect(rwmf_read_case_with(text, "nowhere", &samples, NULL, &scene, TALK) == 0, "reads samples");
   a[1] = 0;
   expect(rwmf_run_case(scene, &two, TALK) == 0, "runs samples, which it has copied");
   expect(one.u_s_max == two.u_s_max && one.steps == two.steps, "the bits of the file's samples");
   rwmf_destroy_case(&scene);
   refuse(rwmf_read_case_with(text, NULL, NULL, &samples, &scene, TALK), "&vertical: samples are");
   times[4] = 1.5;
   refuse(rwmf_read_case_with(text, NULL, &samples, NULL, &scene, TALK), "must increase strictly");
   samples.times = NULL;
   refuse(rwmf_read_case_with(text, NULL, &samples, NULL, &scene, TALK), "needs the key dt");
   samples.n = 1;
   refuse(rwmf_read_case_with(text, NULL, &samples, NULL, &scene, TALK), "at least 2 samples");
   samples.n = (size_t)-1;
   refuse(rwmf_read_case_with(text, NULL, &samples, NULL, &scene, TALK), "out of range");
   samples.accelerations = NULL;
   refuse(rwmf_read_case_with(text, NULL, &samples, NULL, &scene, TALK), "is NULL");
   expect(scene == NULL, "nothing is made");
}

/* What a case of a file cannot do is said of the file. */
static void test_no_period(void) {
   rwmf_case *scene = NULL;
   rwmf_result result;
   rwmf_wall *wall = NULL;

   write_file("spectrum.nml", "&frame xi_s = 0.05 /\n&solver t_end = 1 /\n&spectrum T_s = 1 /\n");
   expect(rwmf_read_case_file("spectrum.nml", &scene, TALK) == 0, "reads a spectrum");
   refuse(rwmf_run_case(scene, &result, TALK), "spectrum.nml: &frame (line 1): the key T_s");
   refuse(rwmf_create_from_case(scene, 0, 0, &wall, TALK), "spectrum.nml: &frame (line 1)");
   rwmf_destroy_case(&scene);
   remove("spectrum.nml");
}

int main(void) {
   const char *record = "0 0\n0.5 4\n1 -4\n1.5 3\n2 0\n";

   write_file("case.nml", text);
   write_file("record.txt", record);
   test_same_bits();
   write_file("record.txt", record);
   test_bad_calls();
   test_samples();
   test_no_period();
   remove("record.txt");
   remove("case.nml");
   return failures != 0;
}
