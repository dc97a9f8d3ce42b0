!> CSV files: names, text of the case, bits of extreme numbers.
program test_output
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_quiet_nan, ieee_value
   use check, only: checks_t
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: i8, wp
   use rwmf_output_csv, only: case_name, write_result
   use rwmf_problem_case, only: case_t
   use rwmf_problem_quantity_table, only: id
   use rwmf_problem_quantity_values, only: put
   use rwmf_simulation_state_result, only: result_t
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
   if (checks%wants('summary_file')) call test_summary_file()
   if (checks%wants('history_bits')) call test_history_bits()
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
      call put(result%values, id%u_s_max_m, result%u_s_max)
      call put(result%values, id%impacts, 3_i8)
      result%steps = 10
      result%rhs_evaluations = 20
      result%method = 'adams'
      result%rtol = 1.0e-9_wp
      result%seconds = 0.25_wp
      result%warnings = [character(256) :: 'first', 'say "no"']
   end subroutine make_result

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
