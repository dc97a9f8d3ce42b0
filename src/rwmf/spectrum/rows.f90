!> Runs of one scene whose numbers differ: those of a grid of axes, or those of a table. Each is a
!> *row* with a number, from which its case follows: no row is kept, so that there may be millions.
module rwmf_spectrum_rows
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_change, only: change_case, changes_t, find_changes
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t, piecewise_linear_motion
   use rwmf_problem_case, only: case_t, spectrum_spec_t
   use rwmf_problem_record, only: set_factor
   use rwmf_problem_scene_axes, only: set_axes
   use rwmf_text_strings, only: real_to_text, to_lower
   implicit none
   private

   public :: rows_t, rows_of_grid, rows_of_table, take_row, scene_of, period_of, spectrum_periods
   public :: common_motion, row_motion, compare_lines

   character(*), parameter :: axes(4) = [character(5) :: 'T_s', 'gamma', 'b', 'scale']
   !! columns that are no keys: what `set_axes` sets, and a factor on the motion

   !> Where the numbers of the runs come from.
   type :: rows_t
      type(case_t), pointer :: case => null()
      !! what they have in common, samples of records included
      integer :: n = 0
      !! number of rows
      real(wp), allocatable :: T_s(:), gamma(:), b(:)
      !! axes of a grid, T_s running fastest [s], [-], [m]; gamma and b not allocated without a wall
      real(wp), pointer :: table(:, :) => null()
      !! (columns, rows) otherwise, each in the unit of its key
      integer :: axis_column(4) = 0
      !! column of each of `axes`, 0 for none
      integer, allocatable :: key_columns(:)
      !! columns of the keys of `changes`
      type(changes_t) :: changes
      logical :: has_own_motion = .false.
      !! a number of the motion differs
      logical :: has_own_shape = .false.
      !! and not only its size
      logical :: has_own_method = .false.
      !! a number of the solver differs
      logical :: is_one_scene = .false.
      !! nothing differs but the period and the size of the motion
   end type rows_t

contains

   !> The grid of a case's `&spectrum` group.
   subroutine rows_of_grid(case, rows)
      type(case_t), intent(in), target :: case
      !! outlives the rows
      type(rows_t), intent(out) :: rows

      rows%case => case
      rows%T_s = spectrum_periods(case%spectrum)
      rows%n = size(rows%T_s)
      if (.not. allocated(case%wall)) return
      if (allocated(case%spectrum%gamma)) then
         rows%gamma = case%spectrum%gamma
      else
         rows%gamma = [case%frame%gamma]
      end if
      rows%b = [case%wall%b]
      if (allocated(case%spectrum%b)) rows%b = case%spectrum%b
      rows%n = size(rows%T_s)*size(rows%gamma)*size(rows%b)
   end subroutine rows_of_grid

   !> The rows of a table. Errors: a column that is neither an axis nor a key that may change.
   subroutine rows_of_table(case, columns, values, rows, error)
      type(case_t), intent(in), target :: case
      !! outlives the rows
      character(*), intent(in) :: columns(:)
      !! (columns) 'T_s', 'gamma', 'b', 'scale' (a factor on the horizontal motion) or 'group.key'
      real(wp), intent(in), target, contiguous :: values(:, :)
      !! (columns, rows) each in the unit of its key; outlives the rows
      type(rows_t), intent(out) :: rows
      type(error_t), allocatable, intent(out) :: error
      integer :: i, axis

      rows%case => case
      rows%table => values
      rows%n = size(values, 2)
      rows%is_one_scene = .true.
      allocate (rows%key_columns(0))
      do i = 1, size(columns)
         axis = findloc(axes == columns(i), .true., dim=1)
         if (axis > 0) then
            call add_axis(case, axis, i, rows, error)
         else
            rows%key_columns = [rows%key_columns, i]
            call note_key(case, to_lower(trim(columns(i))), rows)
         end if
         if (allocated(error)) return
      end do
      if (size(rows%key_columns) > 0) call find_changes(case, columns(rows%key_columns), &
         rows%changes, error)
   end subroutine rows_of_table

   !> A column that is an axis.
   subroutine add_axis(case, axis, column, rows, error)
      type(case_t), intent(in) :: case
      integer, intent(in) :: axis
      !! its place in `axes`
      integer, intent(in) :: column
      type(rows_t), intent(inout) :: rows
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: missing

      missing = ''
      if (axis <= 2 .and. .not. allocated(case%frame)) missing = '&frame'
      if ((axis == 2 .or. axis == 3) .and. .not. allocated(case%wall)) missing = '&wall'
      if (axis == 4 .and. .not. allocated(case%motion)) missing = '&motion'
      if (missing /= '') then
         call fail(error, err_input, trim(axes(axis))//': the case has no '//missing)
      else if (rows%axis_column(axis) > 0) then
         call fail(error, err_input, trim(axes(axis))//': the column is given twice')
      end if
      if (allocated(error)) return
      rows%axis_column(axis) = column
      rows%is_one_scene = rows%is_one_scene .and. (axis == 1 .or. axis == 4)
      rows%has_own_motion = rows%has_own_motion .or. axis == 4
   end subroutine add_axis

   !> What a column that is a key makes different.
   pure subroutine note_key(case, key, rows)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: key
      !! 'group.key' in small letters
      type(rows_t), intent(inout) :: rows

      rows%is_one_scene = rows%is_one_scene .and. (key == 'frame.t_s' .or. key == 'motion.scale' &
         .or. key == 'motion.a_max_g' .or. key == 'motion.v_p')
      rows%has_own_method = rows%has_own_method .or. index(key, 'solver.') == 1 &
         .or. index(key, 'output.') == 1
      if (key == 'model.g') then
         rows%has_own_motion = rows%has_own_motion .or. allocated(case%motion)
      else if (index(key, 'motion.') == 1 .or. index(key, 'vertical.') == 1) then
         rows%has_own_motion = .true.
         rows%has_own_shape = rows%has_own_shape .or. .not. (key == 'motion.scale' &
            .or. key == 'motion.a_max_g' .or. key == 'motion.v_p' .or. key == 'vertical.ratio')
      end if
   end subroutine note_key

   !> Periods of a `&spectrum`: the list, or the grid with both ends included [s].
   pure function spectrum_periods(spec) result(T_s)
      type(spectrum_spec_t), intent(in) :: spec
      real(wp), allocatable :: T_s(:)
      !! (n_T)
      real(wp) :: x
      integer :: i

      if (allocated(spec%T_s)) then
         T_s = spec%T_s
         return
      end if
      allocate (T_s(spec%n))
      do i = 1, spec%n
         x = real(i - 1, wp)/real(max(1, spec%n - 1), wp)
         if (spec%spacing == 'log') then
            T_s(i) = spec%T_s_min*(spec%T_s_max/spec%T_s_min)**x
         else
            T_s(i) = spec%T_s_min + x*(spec%T_s_max - spec%T_s_min)
         end if
      end do
      if (spec%n > 1) T_s(spec%n) = spec%T_s_max
   end function spectrum_periods

   !> Period of a row, as far as its axes say [s].
   pure real(wp) function period_of(rows, number) result(T_s)
      type(rows_t), intent(in) :: rows
      integer, intent(in) :: number
      !! of the row

      T_s = 1
      if (.not. associated(rows%table)) then
         T_s = rows%T_s(mod(number - 1, size(rows%T_s)) + 1)
      else if (rows%axis_column(1) > 0) then
         T_s = rows%table(rows%axis_column(1), number)
      end if
   end function period_of

   !> Number of the scene of a row: rows of one scene differ only in the period and in the size of
   !> the motion.
   pure integer function scene_of(rows, number) result(scene)
      type(rows_t), intent(in) :: rows
      integer, intent(in) :: number
      !! of the row

      scene = number
      if (.not. associated(rows%table)) scene = (number - 1)/size(rows%T_s) + 1
      if (rows%is_one_scene) scene = 1
   end function scene_of

   !> The case of a row: its structure, its solver and, where it has its own, its motion.
   !>
   !> Errors: a number that is not allowed, in the words of reading.
   subroutine take_row(rows, number, row, error)
      type(rows_t), intent(in) :: rows
      integer, intent(in) :: number
      type(case_t), intent(inout) :: row
      !! without text and samples
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      if (associated(rows%table)) then
         call take_line(rows, rows%table(:, number), row, error)
         return
      end if
      row%structure_t = rows%case%structure_t
      row%solver = rows%case%solver
      i = number - 1
      call set_axes(row, T_s=rows%T_s(mod(i, size(rows%T_s)) + 1))
      if (.not. allocated(rows%gamma)) return
      i = i/size(rows%T_s)
      call set_axes(row, gamma=rows%gamma(mod(i, size(rows%gamma)) + 1), &
         b=rows%b(i/size(rows%gamma) + 1))
   end subroutine take_row

   !> The case of a line of a table.
   subroutine take_line(rows, x, row, error)
      type(rows_t), intent(in) :: rows
      real(wp), intent(in) :: x(:)
      !! (columns)
      type(case_t), intent(inout) :: row
      type(error_t), allocatable, intent(out) :: error
      integer :: axis

      if (size(rows%key_columns) > 0) then
         call change_case(rows%case, rows%changes, real(x(rows%key_columns), dp), row, error)
         if (allocated(error)) return
      else
         row%structure_t = rows%case%structure_t
         row%solver = rows%case%solver
         if (rows%has_own_motion) call take_motion(rows%case, row)
      end if
      do axis = 1, size(axes)
         if (rows%axis_column(axis) == 0) cycle
         associate (value => x(rows%axis_column(axis)))
            if (axis == 4 .and. ieee_is_finite(value)) then
               call scale_motion(rows%case, value, row, error)
               if (allocated(error)) return
               cycle
            else if (axis == 4 .or. .not. ieee_is_finite(value) .or. value < 0 &
                     .or. (axis /= 2 .and. .not. value > 0)) then
               call fail(error, err_input, trim(axes(axis))//' = '//trim(real_to_text(value)) &
                  //': must be a finite number'//trim(merge('    ', ' > 0', axis == 4)))
               return
            end if
            if (axis == 1) call set_axes(row, T_s=value)
            if (axis == 2) call set_axes(row, gamma=value)
            if (axis == 3) call set_axes(row, b=value)
         end associate
      end do
   end subroutine take_line

   !> What describes the motion besides the samples of its records, as they are with the case.
   pure subroutine take_motion(case, row)
      type(case_t), intent(in) :: case
      type(case_t), intent(inout) :: row

      row%motion = case%motion
      if (.not. allocated(case%vertical_record)) return
      if (.not. allocated(row%vertical_record)) allocate (row%vertical_record)
      row%vertical_record%factor = case%vertical_record%factor
   end subroutine take_motion

   !> A factor on the horizontal motion: on the scale of a record, on the size of a pulse.
   subroutine scale_motion(case, factor, row, error)
      type(case_t), intent(in) :: case
      !! that the row comes from
      real(wp), intent(in) :: factor
      !! [-]
      type(case_t), intent(inout) :: row
      type(error_t), allocatable, intent(out) :: error

      if (allocated(row%motion%a_max_g)) row%motion%a_max_g = factor*row%motion%a_max_g
      if (allocated(row%motion%v_p)) row%motion%v_p = factor*row%motion%v_p
      if (.not. allocated(case%record)) return
      if (.not. allocated(row%record)) allocate (row%record)
      if (allocated(case%record%format)) then
         row%record%largest = case%record%largest
         row%motion%scale = factor*row%motion%scale
         call set_factor(row%record, row%motion%scale, row%model%g, error, row%motion%unit)
      else
         row%record%factor = factor*case%record%factor
      end if
   end subroutine scale_motion

   !> The motion of all rows; where they have their own, the lines that those of records are
   !> multiples of.
   function common_motion(rows) result(motion)
      type(rows_t), intent(in) :: rows
      type(motion_t) :: motion

      if (rows%has_own_motion .and. allocated(rows%case%record)) then
         motion = piecewise_linear_motion(rows%case%record%t, rows%case%record%a, 1.0_wp)
      else
         motion = motion_from_case(rows%case)
      end if
   end function common_motion

   !> How a row's own motion compares with the common one.
   pure subroutine compare_lines(rows, row, is_shaken, factor, ratio)
      type(rows_t), intent(in) :: rows
      type(case_t), intent(in) :: row
      !! from `take_row`
      logical, intent(in) :: is_shaken
      !! it has yet another factor
      real(wp), intent(out) :: factor
      !! of its lines, 0 when they are no multiples [-]
      real(wp), intent(out) :: ratio
      !! of the vertical to the horizontal acceleration [-]

      factor = 0
      ratio = 1
      if (is_shaken .or. rows%has_own_shape .or. .not. allocated(rows%case%record) &
          .or. allocated(rows%case%vertical_record)) return
      factor = rows%case%record%factor
      if (allocated(row%record)) factor = row%record%factor
      if (.not. allocated(row%vertical)) return
      if (allocated(row%vertical%ratio)) ratio = row%vertical%ratio
   end subroutine compare_lines

   !> The motion of a row that has its own.
   function row_motion(rows, row) result(motion)
      type(rows_t), intent(in) :: rows
      type(case_t), intent(in) :: row
      !! from `take_row`
      type(motion_t) :: motion

      motion = motion_from_case(row, rows%case)
   end function row_motion

end module rwmf_spectrum_rows
