"""What grading has to survive, and the cases that show for each that it does.

A case is the name of an attack, of a damage or of honest work beside this file, or ``file.py::test`` below
``tests/``. A threat without a case fails the tests, and so does a case that is not there.
"""

ENDING = {
    "a loop that does not end": ("endless loop", "endless loop at import", "loop that swallows everything", "a destructor that never ends", "a trace that never ends"),
    "compiled code that does not come back": ("loop in compiled code", "recursion in compiled code"),
    "signals and alarms switched off": ("signals ignored", "the alarm switched off", "SIGSTOP to itself"),
    "the interpreter left": ("sys.exit", "SystemExit that claims a pass", "KeyboardInterrupt raised"),
    "the process ended at once": ("os._exit", "os._exit at import", "exit by ctypes", "os.abort"),
    "the process killed by itself": ("SIGKILL to itself",),
    "memory that is not there": ("segmentation fault",),
    "calls without a bottom": ("recursion",),
    "something that hangs after the end": ("thread that never ends", "exit handler that hangs"),
    "processes without end": ("fork bomb", "processes by raw calls"),
    "a process that stays behind": ("orphan after a double fork", "sandbox/test_proxy.py::test_a_process_that_left_somebody_behind_with_its_pipes_is_not_waited_for"),
    "a question to the keyboard": ("input",),
    "waiting for what never comes": ("sleep for ever", "a lock that nobody frees", "a pipe that nobody writes to"),
}  # fmt: skip

RESOURCES = {
    "memory bit by bit": ("memory that grows",),
    "memory at one stroke": ("one huge allocation", "a thousand million numbers"),
    "a flood of output": ("output flood",),
    "a full disk": ("one file that fills the disk", "several files that fill the disk", "many small files"),
    "a result that is too large": ("array of a thousand million zeros", "a thousand million bytes", "a list of a million lists", "an enormous sparse matrix"),
    "a result that is never finished": ("endless iterator as result", "endless list as result", "a generator as result", "range of a million millions"),
    "threads of numerics, and others": ("threads of BLAS", "threads without end"),
    "text without end": ("a message of a hundred million letters", "a class of a million letters"),
}  # fmt: skip

TAMPERING = {
    "comparisons of numpy replaced": ("patched numpy",),
    "arithmetic of numpy replaced": ("ufuncs patched",),
    "built-in functions and exceptions replaced": ("patched builtins", "import and open patched"),
    "a test runner replaced": ("pytest faked",),
    "the course replaced": ("a false grader put into sys.modules", "the worker's own module patched", "later answers replaced", "another exercise replaced", "the coder patched"),
    "the notebook's shell changed": ("transformers of IPython",),
    "hooks of the interpreter": ("hooks for errors and the end",),
    "the table of modules changed": ("sys.modules emptied",),
    "a module of one's own in place of a library": ("a numpy of its own",),
    "chance": ("random generators patched", "random generators broken", "random generators seeded anew"),
    "clocks": ("clocks that stand still",),
    "expected values looked for in frames and memory": ("frames searched", "memory searched"),
    "solutions by import": ("checks and reference imported", "reference imported from its place"),
    "solutions by inspection": ("solutions by inspect",),
    "solutions where packages lie": ("where the course is installed", "reference read"),
    "solutions by way of folders above": ("the folder above", "tests and solutions beside the course"),
    "other processes": ("the grader's process", "memory of processes", "a signal by pipe to whoever reads it"),
    "the work of others": ("another submission", "a link to another submission", "a hard link to another submission"),
    "the environment and the seed": ("the environment", "frames searched"),
    "grades and results changed": ("grade book changed",),
    "what all workers share changed": ("the package of all workers changed", "the folder of packages changed"),
    "a verdict written where the grader may read": ("forged verdict on stdout", "forged verdict on every descriptor", "frames for the questions to come", "sandbox/test_proxy.py::test_a_forged_reply_is_an_answer_at_most"),
    "a reply that is no reply": ("a frame that never ends", "a frame that announces everything", "struct patched", "json patched", "sandbox/test_wire.py::test_a_damaged_frame_gives_a_value_or_a_wire_error"),
    "a reply that runs code": ("a pickle", "a pickle on every descriptor"),
    "a result that claims to be equal": ("a result that equals everything", "an array that equals everything", "a number that equals everything", "a text that equals everything"),
    "a result that breaks whoever reads it": ("a sparse matrix that points out of its memory", "an object that plays a sparse matrix", "an array at an address of its choice", "a mesh with records of its own"),
    "answers that depend on who asks": ("works only outside of grading", "the course told apart from its stand-in", "right only at leisure"),
    "answers for the questions that were seen": ("answers learnt by heart",),
    "arguments changed": ("input changed in place", "sandbox/test_proxy.py::test_changed_inputs_are_named"),
    "memory between calls": ("state between calls",),
    "the network": ("sockets", "the network by a library"),
    "other programs and rights": ("other programs", "another user", "limits raised", "calls into the kernel"),
    "links in what is handed in": ("grading/test_submission.py::test_links_out_of_the_folder_are_not_followed",),
    "archives that swell": ("grading/test_intake.py::test_a_bomb_takes_no_more_memory_than_its_bound", "grading/test_intake.py::test_many_files_of_a_fair_ratio_stop_at_the_sum"),
    "archives that lead elsewhere": ("grading/test_intake.py::test_a_path_out_of_the_folder_leads_nowhere",),
}  # fmt: skip

DAMAGED = {
    "cells that are copied, lost, moved or of another kind": ("a cell copied", "a cell deleted", "cells in reverse order", "a cell made text", "a cell made raw"),
    "fields that are lost": ("metadata stripped", "all but type and source stripped"),
    "ids": ("ids missing from new cells", "ids repeated", "ids of the wrong kind"),
    "formats of old": ("format 3", "format 4 point 0"),
    "what is no notebook": ("invalid JSON", "an empty file", "a web page", "a file cut off"),
    "ways to write text": ("a byte-order mark", "Latin-1", "UTF-16"),
    "another name or kernel": ("a renamed file", "an unknown kernel"),
    "lines that are not Python": ("magics and shell lines", "a cell of another language"),
    "an error in one cell": ("a syntax error in a cell",),
    "a name that is bound twice": ("an exercise defined twice", "an exercise defined twice, wrong at last"),
    "outputs that were saved": ("saved outputs that claim a pass", "metadata that claims a pass"),
    "helpers of one's own": ("helpers in cells of their own",),
    "a name that is not the asked one": ("a function renamed",),
    "a script": ("a script instead",),
    "a notebook that is too much for whoever reads it": ("millions of lists", "cells by the ten thousand", "definitions by the thousand", "expressions that are too deep", "a number of a million digits", "a line of two million characters"),
    "damage at random": ("grading/hostile/test_fuzz.py::test_every_damaged_notebook_gets_a_row_and_the_marks_of_what_is_whole",),
}  # fmt: skip

HONEST = {
    "output of every kind": ("prints", "prints on stderr", "warnings", "a plot", "a progress bar"),
    "values of every kind": ("a list of lists", "a tuple of tuples", "single precision", "an array of one number", "sparse csr", "sparse dok", "exercises/test_expect.py::test_an_array_may_be_sparse_or_a_list"),
    "freedoms of sign, order and basis": ("test_course.py::test_every_right_solution_passes_on_every_seed",),
    "slow work": ("slow, but within its limit", "sandbox/test_proxy.py::test_a_busy_machine_takes_nothing_from_a_limit"),
    "recursion and classes": ("recursion", "deep recursion", "a class of one's own"),
    "exercises that use each other": ("exercises that call each other",),
    "letters and line ends": ("a comment in Chinese", "Windows line ends"),
}  # fmt: skip

OPERATIONS = {
    "an interruption": ("grading/test_grade.py::test_an_interruption_does_not_wait_for_who_is_being_graded",),
    "results that cannot be written": ("grading/test_gradebook.py::test_a_file_is_written_as_a_whole",),
    "names of students": ("grading/test_gradebook.py::test_no_cell_is_a_formula_and_no_row_breaks", "grading/test_gradebook.py::test_what_a_student_writes_is_text_on_a_page"),
}  # fmt: skip

THREATS = {**ENDING, **RESOURCES, **TAMPERING, **DAMAGED, **HONEST, **OPERATIONS}
