!> CSV files: complete or absent, with the same bits and only the keys that apply.
program test_output
   use, intrinsic :: iso_c_binding, only: c_funptr, c_int, c_intptr_t, c_long, c_null_funptr
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use check, only: checks_t
   use rwmf_core_error, only: err_input, error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_output_csv, only: case_name, write_result, write_spectrum
   use rwmf_output_summary, only: list_effects, summarise, summary_item_t, summary_text
   use rwmf_problem_case, only: case_t
   use rwmf_simulation_state_result, only: result_t
   use rwmf_spectrum_ordinates, only: spectrum_t
   use rwmf_text_strings, only: integer_to_text
   implicit none

   character(:), allocatable :: folder
   type(checks_t) :: checks
   integer(i8) :: ticks

   ! a unique name: builds of several kinds may be tested at the same time
   call system_clock(ticks)
   folder = 'test_output_'//trim(integer_to_text(ticks))
   call execute_command_line('rm -rf '//folder//' && mkdir '//folder)
   if (checks%wants('case_name')) call test_case_name()
   if (checks%wants('summary')) call test_summary()
   if (checks%wants('summary_file')) call test_summary_file()
   if (checks%wants('history_bits')) call test_history_bits()
   if (checks%wants('spectrum_file')) call test_spectrum_file()
   if (checks%wants('bare_spectrum')) call test_bare_spectrum()
   if (checks%wants('missing_folder')) call test_missing_folder()
   if (checks%wants('target_is_folder')) call test_target_is_folder()
   if (checks%wants('full_disk')) call test_full_disk()
   if (checks%wants('input_stays')) call test_input_stays()
   if (checks%wants('link_stays')) call test_link_stays()
   call execute_command_line('rm -rf '//folder)
   call checks%finish()

contains

   !> The name of a case is the name of its file.
   subroutine test_case_name()
      call checks%that(case_name('a/b.c/case.nml') == 'case', 'folder and ending go')
      call checks%that(case_name('plain') == 'plain', 'no ending')
      call checks%that(case_name('.nml') == '.nml', 'only an ending')
      call checks%that(case_name('a.b.nml') == 'a.b', 'only the last ending goes')
      call checks%that(case_name('') == 'case', 'a case from memory')
   end subroutine test_case_name

   !> Absent components have no key; the keys have the order of the contract.
   subroutine test_summary()
      type(case_t) :: case
      type(result_t) :: result
      type(summary_item_t), allocatable :: items(:)
      character(*), parameter :: tab = achar(9), nl = new_line('a')
      character(:), allocatable :: text

      call make_case(case)
      call make_result(result)
      call summarise(case, result, items)
      call summary_text(items, text)
      call checks%that(index(text, 'u_s_max_m'//tab//'real'//tab) == 1, 'first key')
      call checks%that(same_bits(items(1)%number, result%u_s_max), 'number')
      call checks%that(index(text, nl//'impacts'//tab//'int'//tab//nl) > 0, 'counter')
      call checks%that(items(2)%count == 3, 'its number')
      call checks%that(index(text, nl//'overturned'//tab//'logical'//tab//nl) > 0, 'logical')
      call checks%that(items(4)%count == 0, 'its number')
      call checks%that(index(text, 'effects'//tab//'list'//tab//'wall'//tab//'frame'//nl) &
         > 0, 'list')
      call checks%that(index(text, 'cable_force') == 0, 'no cable, no key')
      call checks%that(index(text, 'energy') == 0, 'no ledger, no key')
      call checks%that(size(list_effects(case)) == 2, 'kind none shakes nothing')
      result%has_impacts = .false.
      deallocate (result%u_s_max)
      call summarise(case, result, items)
      call summary_text(items, text)
      call checks%that(index(text, 'impacts') == 0, 'no rocking, no impacts')
      call checks%that(index(text, 'u_s_max_m') == 0, 'no frame, no displacement')
   end subroutine test_summary

   !> One line of names, one of values, and the data needed to repeat the run.
   subroutine test_summary_file()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: u_s_max

      call make_case(case)
      call make_result(result)
      call write_result(case, result, folder, 'run', error)
      call checks%no_error(error, 'summary written')
      call checks%that(line_of('run.summary.csv', 3) == '# &wall h = 2.0 /', 'case text')
      call checks%that(line_of('run.summary.csv', 4) == '# ! second line', 'CRLF')
      call checks%that(index(line_of('run.summary.csv', 5), 'u_s_max_m,impacts,') == 1, &
         'names')
      call checks%that(index(line_of('run.summary.csv', 6), '; say ""no"""') > 0, 'quotes')
      u_s_max = first_number(line_of('run.summary.csv', 6))
      call checks%that(same_bits(u_s_max, result%u_s_max), 'bits of the summary')
      call checks%that(count_files() == 1, 'no history, no temporary file')
   end subroutine test_summary_file

   !> Extreme numbers keep all their bits; after overturning the values are NaN.
   subroutine test_history_bits()
      real(wp), parameter :: third = 1.0_wp/3.0_wp
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      real(wp) :: values(8)
      real(wp) :: back
      integer :: i

      values = [third, -third, tiny(third), 1.7e308_wp, 0.1_wp, -0.0_wp, 1.0e-300_wp, third]
      values(8) = ieee_value(third, ieee_quiet_nan)
      call make_case(case)
      call make_result(result)
      allocate (result%history)
      result%history%names = [character(32) :: 't_s', 'theta_rad']
      result%history%values = reshape([values, values], [8, 2])
      call write_result(case, result, folder, 'run', error)
      call checks%no_error(error, 'history written')
      call checks%that(line_of('run.history.csv', 5) == 't_s,theta_rad', 'columns')
      do i = 1, size(values)
         back = first_number(line_of('run.history.csv', 5 + i))
         call checks%that(same_bits(back, values(i)) &
            .or. ieee_is_nan(back) .and. ieee_is_nan(values(i)), 'bits of the history')
      end do
   end subroutine test_history_bits

   !> T_s varies fastest, then gamma, then b; a failed ordinate keeps its reason.
   subroutine test_spectrum_file()
      type(case_t) :: case
      type(spectrum_t) :: spectrum
      type(error_t), allocatable :: error
      character(:), allocatable :: line

      call make_case(case)
      call make_spectrum(spectrum)
      spectrum%gamma = [5.0_wp, 10.0_wp]
      spectrum%b = [0.5_wp]
      spectrum%status(2, 1, 1) = 2
      call write_spectrum(case, spectrum, folder//'/s.csv', error)
      call checks%no_error(error, 'spectrum written')
      call checks%that(line_of('s.csv', 5) == '# method: adams', 'method of the spectrum')
      call checks%that(line_of('s.csv', 6) == 'b_m,gamma,T_s_s,u_s_max_m,status', &
         'columns of the spectrum')
      line = line_of('s.csv', 8)
      call checks%that(index(line, ',too_many_steps') == len(line) - 14, 'reason')
      call checks%that(same_bits(first_number(line), 0.5_wp), 'b comes first')
      call checks%that(line_of('s.csv', 11) == '', 'four ordinates')
   end subroutine test_spectrum_file

   !> The bare frame has neither gamma nor b.
   subroutine test_bare_spectrum()
      type(case_t) :: case
      type(spectrum_t) :: spectrum
      type(error_t), allocatable :: error

      call make_case(case)
      call make_spectrum(spectrum)
      call write_spectrum(case, spectrum, folder//'/s.csv', error)
      call checks%that(line_of('s.csv', 6) == 'T_s_s,u_s_max_m,status', 'bare frame')
   end subroutine test_bare_spectrum

   !> The error names a folder that does not exist.
   subroutine test_missing_folder()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error

      call make_case(case)
      call make_result(result)
      call write_result(case, result, 'no/such/folder', 'run', error)
      call checks%has_error(error, err_input, 'no/such/folder', 'missing folder')
   end subroutine test_missing_folder

   !> A target that cannot be replaced leaves all files unchanged.
   subroutine test_target_is_folder()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      integer :: before

      call execute_command_line('mkdir '//folder//'/taken.summary.csv')
      before = count_files()
      call make_case(case)
      call make_result(result)
      call write_result(case, result, folder, 'taken', error)
      call checks%has_error(error, err_input, 'taken.summary.csv', 'target is a folder')
      call checks%that(count_files() == before, 'no temporary file stays')
   end subroutine test_target_is_folder

   !> On a full disk the earlier file stays and the temporary file is deleted. A limit on the file
   !> size simulates the full disk.
   subroutine test_full_disk()
      integer(c_long), parameter :: few_bytes = 8192_c_long
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      character(:), allocatable :: earlier
      integer :: before

      call make_case(case)
      call make_result(result)
      earlier = line_of('run.summary.csv', 6)
      before = count_files()
      result%steps = 99
      allocate (result%history)
      result%history%names = [character(32) :: 't_s']
      allocate (result%history%values(20000, 1), source=0.1_wp)
      call limit_file_size(few_bytes)
      call write_result(case, result, folder, 'run', error)
      call limit_file_size(huge(few_bytes))
      call checks%has_error(error, err_input, 'run.history.csv', 'full disk')
      call checks%that(line_of('run.summary.csv', 6) == earlier, 'earlier file untouched')
      call checks%that(count_files() == before, 'temporary files removed')
   end subroutine test_full_disk

   !> The input file of a case is never overwritten by a result, under any of its names.
   subroutine test_input_stays()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      integer :: before

      call execute_command_line('cd '//folder//' && echo samples > motion.txt' &
         //' && ln -s motion.txt link.history.csv && ln motion.txt hard.summary.csv')
      call make_case(case)
      call make_result(result)
      allocate (case%record)
      case%motion%path = folder//'/../'//folder//'/motion.txt'
      before = count_files()
      call write_result(case, result, folder, 'link', error)
      call checks%has_error(error, err_input, 'link.history.csv', 'a link to the record')
      call write_result(case, result, folder, 'hard', error)
      call checks%has_error(error, err_input, 'hard.summary.csv', 'another name of the record')
      deallocate (case%record)
      call write_result(case, result, folder, 'case', error, folder//'/motion.txt')
      call checks%no_error(error, 'nothing is read that is written')
      call write_result(case, result, folder, 'hard', error, folder//'/motion.txt')
      call checks%has_error(error, err_input, 'hard.summary.csv', 'another name of the case')
      call checks%that(line_of('motion.txt', 1) == 'samples', 'the record stays')
      call checks%that(count_files() == before + 1, 'nothing else was written')
   end subroutine test_input_stays

   !> A link is kept and its target receives the result; a device remains a device.
   subroutine test_link_stays()
      type(case_t) :: case
      type(result_t) :: result
      type(error_t), allocatable :: error
      integer :: status

      call execute_command_line('cd '//folder//' && mkdir place' &
         //' && ln -s place/target linked.summary.csv && ln -s /dev/null null.summary.csv')
      call make_case(case)
      call make_result(result)
      call write_result(case, result, folder, 'linked', error)
      call checks%no_error(error, 'written to the target of a link')
      call checks%that(line_of('place/target', 3) == '# &wall h = 2.0 /', 'the target')
      call write_result(case, result, folder, 'null', error)
      call checks%no_error(error, 'written to a device')
      call execute_command_line('cd '//folder//' && test -h linked.summary.csv' &
         //' && test -h null.summary.csv && test -c /dev/null', exitstat=status)
      call checks%that(status == 0, 'links and device stay')
   end subroutine test_link_stays

   !> Limit the size of files from now on.
   subroutine limit_file_size(bytes)
      integer(c_long), intent(in) :: bytes
      integer(c_int), parameter :: rlimit_fsize = 1_c_int, sigxfsz = 25_c_int
      integer(c_intptr_t), parameter :: sig_ign = 1_c_intptr_t
      type(c_funptr) :: previous
      integer(c_long) :: limits(2)
      integer(c_int) :: status

      interface
         function c_getrlimit(resource, limits) bind(c, name='getrlimit') result(status)
            import :: c_int, c_long
            implicit none
            integer(c_int), intent(in), value :: resource
            integer(c_long), intent(out) :: limits(2)
            integer(c_int) :: status
         end function c_getrlimit

         function c_setrlimit(resource, limits) bind(c, name='setrlimit') result(status)
            import :: c_int, c_long
            implicit none
            integer(c_int), intent(in), value :: resource
            integer(c_long), intent(in) :: limits(2)
            integer(c_int) :: status
         end function c_setrlimit

         function c_signal(number, handler) bind(c, name='signal') result(previous)
            import :: c_funptr, c_int
            implicit none
            integer(c_int), intent(in), value :: number
            type(c_funptr), intent(in), value :: handler
            type(c_funptr) :: previous
         end function c_signal
      end interface

      ! without this the signal for a too large file would end the program
      previous = c_signal(sigxfsz, transfer(sig_ign, c_null_funptr))
      status = c_getrlimit(rlimit_fsize, limits)
      limits(1) = bytes
      if (limits(2) >= 0_c_long) limits(1) = min(bytes, limits(2))
      if (status == 0_c_int) status = c_setrlimit(rlimit_fsize, limits)
      call checks%that(status == 0_c_int, 'limit on file sizes')
   end subroutine limit_file_size

   !> A wall and a frame in free vibration.
   subroutine make_case(case)
      type(case_t), intent(out) :: case

      allocate (case%wall, case%frame, case%motion)
      case%impact%rule = 'none'
      case%text = '&wall h = 2.0 /'//achar(13)//new_line('a')//'! second line'//new_line('a')
      case%motion%kind = 'none'
      case%solver%method = 'adams'
      case%solver%rtol = 1.0e-9_wp
   end subroutine make_case

   !> A result with a few scalars.
   subroutine make_result(result)
      type(result_t), intent(out) :: result

      result%u_s_max = 1.0_wp/3.0_wp
      result%has_impacts = .true.
      result%impacts = 3
      result%lift_offs = 1
      result%overturned = .false.
      result%steps = 10
      result%rhs_evaluations = 20
      result%method = 'adams'
      result%rtol = 1.0e-9_wp
      result%seconds = 0.25_wp
      result%warnings = [character(256) :: 'first', 'say "no"']
   end subroutine make_result

   !> Two periods, two mass ratios or their absence.
   subroutine make_spectrum(spectrum)
      type(spectrum_t), intent(out) :: spectrum

      spectrum%T_s = [1.0_wp, 2.0_wp]
      allocate (spectrum%values(2, 2, 1, 1), source=0.1_wp)
      spectrum%quantities = [character(40) :: 'u_s_max_m']
      allocate (spectrum%status(2, 2, 1))
      spectrum%status = 1
      spectrum%status_names = [character(24) :: 'ok', 'too_many_steps']
      spectrum%rhs_evaluations = 1
      spectrum%seconds = 0.0_wp
      spectrum%threads = 1
   end subroutine make_spectrum

   !> Line of a file in the folder of the test; '' if the file has fewer lines.
   function line_of(name, number) result(line)
      character(*), intent(in) :: name
      integer, intent(in) :: number
      character(:), allocatable :: line
      character(4096) :: buffer
      integer :: i
      integer :: status
      integer :: unit

      line = ''
      open (newunit=unit, file=folder//'/'//name, status='old', action='read', iostat=status)
      if (status /= 0) return
      do i = 1, number
         read (unit, '(a)', iostat=status) buffer
         if (status /= 0) exit
      end do
      if (status == 0) line = trim(buffer)
      close (unit)
   end function line_of

   !> The first number of a line of a CSV file.
   real(wp) function first_number(line)
      character(*), intent(in) :: line
      integer :: status

      read (line(:scan(line//',', ',') - 1), *, iostat=status) first_number
      call checks%that(status == 0, 'a number: '//line)
   end function first_number

   !> True if two reals are equal, the sign of zero included.
   logical function same_bits(a, b)
      real(wp), intent(in) :: a
      real(wp), intent(in) :: b
      character(storage_size(1.0_wp)/8) :: mould

      same_bits = transfer(a, mould) == transfer(b, mould)
   end function same_bits

   !> Number of entries in the folder of the test, hidden ones included.
   integer function count_files()
      integer :: status
      integer :: unit

      call execute_command_line('ls -A '//folder//' | wc -l > '//folder//'.count')
      count_files = -1
      open (newunit=unit, file=folder//'.count', status='old', action='read', iostat=status)
      if (status /= 0) return
      read (unit, *, iostat=status) count_files
      if (status /= 0) count_files = -1
      close (unit, status='delete')
   end function count_files

end program test_output
