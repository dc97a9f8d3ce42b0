!> Runs of one scene with different numbers, from a grid of axes or from a table.
!>
!> Each run is a *row*. Its case is computed from the row number when needed, so millions of rows
!> need no memory for cases.
module rwmf_spectrum_rows
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_change, only: change_case, changes_t, find_changes
   use rwmf_motion_ground_motion, only: motion_from_case, motion_t
   use rwmf_problem_case, only: case_t, has_floors, spectrum_spec_t, wall_t
   use rwmf_problem_record, only: set_factor, sets_motion
   use rwmf_problem_scene_axes, only: axis_t, list_axes, set_axes
   use rwmf_problem_single_run, only: check_single_run
   use rwmf_problem_wall_size, only: scale_to_period
   use rwmf_text_decimal, only: short_decimal
   use rwmf_text_strings, only: real_to_text, to_lower
   implicit none
   private

   public :: rows_t, rows_of_grid, rows_of_table, take_row, period_of, spectrum_periods
   public :: row_motion

   character(*), parameter :: axes(4) = [character(5) :: 'b', 'gamma', 'T_s', 'scale']
   !! columns that are not keys: the axes of `set_axes`, and a factor on the motion. `b` precedes
   !! `T_s`, which scales a block of this width
   character(*), parameter :: axis_keys(3) = [character(11) :: 'wall.b', 'frame.gamma', &
      'frame.t_s']
   !! keys set by the first three axes, in lower case
   integer, parameter :: axis_width = 1
   integer, parameter :: axis_period = 3
   integer, parameter :: axis_scale = 4
   !! places in `axes`
   character(6), parameter :: sizes(2) = ['wall.h', 'wall.b']

   !> Source of the numbers of the runs.
   type :: rows_t
      type(case_t), pointer :: case => null()
      !! common data of the runs
      type(case_t), pointer :: origin => null()
      !! case that holds the samples of the records: `case`, or its original if it was changed
      integer :: n = 0
      !! number of rows
      real(wp), allocatable :: T_s(:), gamma(:), b(:)
      !! axes of a grid, T_s varying fastest [s], [-], [m]. gamma is allocated only with frame and
      !! wall, b only with a wall
      real(wp), pointer :: table(:, :) => null()
      !! (columns, rows) numbers of a table, each in the unit of its key; null for a grid
      integer :: axis_column(4) = 0
      !! column of each of `axes`, 0 for none
      integer, allocatable :: key_columns(:)
      !! columns of the keys of `changes`
      type(changes_t) :: changes
      logical :: is_sized = .false.
      !! masses follow the size of the wall; its height and width are the last keys of `changes`
      integer :: size_columns(2) = 0
      !! columns of height and width, 0 for none
      logical :: has_own_motion = .false.
      !! the motion differs between rows
      logical :: has_own_estimate = .false.
      !! the requested accuracy or the use of error estimates differs between rows
   end type rows_t

contains

   !> Define the rows of a case's `&spectrum` group.
   subroutine rows_of_grid(case, rows, error, origin)
      type(case_t), intent(in), target :: case
      !! outlives the rows
      type(rows_t), intent(out) :: rows
      type(error_t), allocatable, intent(out) :: error
      !! the keys of the wall's size cannot vary
      type(case_t), intent(in), target, optional :: origin
      !! original of a changed case, which holds the samples of its records; outlives the rows

      rows%case => case
      rows%origin => case
      if (present(origin)) rows%origin => origin
      rows%T_s = spectrum_periods(case%spectrum)
      rows%n = size(rows%T_s)
      if (.not. allocated(case%wall)) return
      if (allocated(case%frame)) rows%gamma = [case%frame%gamma]
      if (allocated(case%spectrum%gamma)) rows%gamma = case%spectrum%gamma
      if (allocated(rows%gamma)) rows%n = rows%n*size(rows%gamma)
      rows%b = [case%wall%b]
      if (allocated(case%spectrum%b)) rows%b = case%spectrum%b
      rows%n = rows%n*size(rows%b)
      rows%is_sized = case%follows_size .and. (allocated(case%spectrum%b) &
         .or. .not. allocated(case%frame))
      if (rows%is_sized) call find_changes(case, sizes, rows%changes, error)
   end subroutine rows_of_grid

   !> Define the rows of a table.
   !>
   !> Errors: a column that is neither an axis nor a key that may vary, or two columns that set the
   !> same key. A frame without a period and without a column for it is an error, too.
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
      rows%origin => case
      rows%table => values
      rows%n = size(values, 2)
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
      call check_once(columns, rows, error)
      if (allocated(error)) return
      rows%is_sized = case%follows_size .and. (rows%axis_column(axis_width) > 0 &
         .or. (rows%axis_column(axis_period) > 0 .and. .not. allocated(case%frame)))
      if (rows%is_sized) then
         ! the keys whose masses follow the size of the wall, with height and width
         do i = 1, size(sizes)
            rows%size_columns(i) = findloc(to_lower(columns) == sizes(i), .true., dim=1)
            rows%key_columns = pack(rows%key_columns, rows%key_columns /= rows%size_columns(i))
         end do
         call find_changes(case, [character(len(columns)) :: columns(rows%key_columns), sizes], &
            rows%changes, error)
      else if (size(rows%key_columns) > 0) then
         call find_changes(case, columns(rows%key_columns), rows%changes, error)
      end if
      if (allocated(error) .or. rows%axis_column(axis_period) > 0) return
      do i = 1, size(rows%key_columns)
         if (to_lower(trim(columns(rows%key_columns(i)))) == 'frame.t_s') return
      end do
      call check_single_run(case, error)
   end subroutine rows_of_table

   !> Add a column that is an axis.
   subroutine add_axis(case, axis, column, rows, error)
      type(case_t), intent(in) :: case
      integer, intent(in) :: axis
      !! place of the axis in `axes`
      integer, intent(in) :: column
      type(rows_t), intent(inout) :: rows
      type(error_t), allocatable, intent(out) :: error
      type(axis_t), allocatable :: own(:)
      logical :: is_missing

      call list_axes(case, own)
      is_missing = .not. any(own%name == axes(axis))
      if (axis == axis_scale) is_missing = .not. allocated(case%motion)
      if (is_missing) then
         call fail(error, err_input, trim(axes(axis))//': the case has no such effect to vary')
      else if (rows%axis_column(axis) > 0) then
         call fail(error, err_input, trim(axes(axis))//': the column is given twice')
      end if
      if (allocated(error)) return
      rows%axis_column(axis) = column
      rows%has_own_motion = rows%has_own_motion .or. axis == axis_scale
   end subroutine add_axis

   !> Check that no column sets an axis a second time by its key.
   subroutine check_once(columns, rows, error)
      character(*), intent(in) :: columns(:)
      !! (columns)
      type(rows_t), intent(in) :: rows
      type(error_t), allocatable, intent(out) :: error
      integer :: axis, i

      do axis = 1, size(axis_keys)
         if (rows%axis_column(axis) == 0) cycle
         do i = 1, size(rows%key_columns)
            associate (key => columns(rows%key_columns(i)))
               if (to_lower(trim(key)) /= axis_keys(axis)) cycle
               call fail(error, err_input, trim(axes(axis))//', '//trim(key) &
                  //': both columns set the same key')
               return
            end associate
         end do
      end do
   end subroutine check_once

   !> Note which properties of the rows vary with a column that is a key.
   pure subroutine note_key(case, key, rows)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: key
      !! 'group.key' in lower case
      type(rows_t), intent(inout) :: rows

      rows%has_own_estimate = rows%has_own_estimate .or. key == 'solver.accuracy' &
         .or. key == 'solver.verify'
      if (key == 'model.g') then
         rows%has_own_motion = rows%has_own_motion .or. allocated(case%motion)
      else if (sets_motion(key(:index(key, '.') - 1))) then
         rows%has_own_motion = .true.
      end if
   end subroutine note_key

   !> Periods of a `&spectrum` group, from its list or from its grid with both ends [s].
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
            T_s(i) = short_decimal(spec%T_s_min*(spec%T_s_max/spec%T_s_min)**x)
         else
            T_s(i) = short_decimal(spec%T_s_min + x*(spec%T_s_max - spec%T_s_min))
         end if
      end do
      if (spec%n > 1) T_s(spec%n) = spec%T_s_max
   end function spectrum_periods

   !> Period of a row from its axes; 1 if none of them sets it [s].
   pure real(wp) function period_of(rows, number) result(T_s)
      type(rows_t), intent(in) :: rows
      integer, intent(in) :: number
      !! number of the row

      T_s = 1
      if (.not. associated(rows%table)) then
         T_s = rows%T_s(mod(number - 1, size(rows%T_s)) + 1)
      else if (rows%axis_column(axis_period) > 0) then
         T_s = rows%table(rows%axis_column(axis_period), number)
      end if
   end function period_of

   !> Construct the case of a row: structure, solver and, if it varies, motion.
   !>
   !> Errors: a number that is not allowed, with the message of the input reader.
   subroutine take_row(rows, number, row, error)
      type(rows_t), intent(in) :: rows
      integer, intent(in) :: number
      !! number of the row
      type(case_t), intent(inout) :: row
      !! case without text and samples
      type(error_t), allocatable, intent(out) :: error
      type(wall_t) :: wall
      integer :: i, n_gamma

      if (associated(rows%table)) then
         call take_line(rows, rows%table(:, number), row, error)
         return
      end if
      row%structure_t = rows%case%structure_t
      row%solver = rows%case%solver
      i = (number - 1)/size(rows%T_s)
      n_gamma = 1
      if (allocated(rows%gamma)) n_gamma = size(rows%gamma)
      associate (T_s => period_of(rows, number))
         if (rows%is_sized) then
            wall = rows%case%wall
            wall%b = rows%b(i/n_gamma + 1)
            call take_sized(rows, [real(dp) ::], wall, row, error, T_s)
            if (allocated(error) .or. .not. allocated(rows%case%frame)) return
         end if
         ! without this axis, the mass of the frame is constant and not its ratio
         if (allocated(rows%gamma) .and. (allocated(rows%case%spectrum%gamma) &
                                          .or. .not. rows%is_sized)) then
            call set_axes(row, gamma=rows%gamma(mod(i, n_gamma) + 1))
         end if
         if (allocated(rows%b)) call set_axes(row, b=rows%b(i/n_gamma + 1))
         ! the period of a block scales its width, so it is set last
         call set_axes(row, T_s=T_s)
      end associate
   end subroutine take_row

   !> Construct the case of a wall of another size, with its masses.
   !>
   !> The size changes with the width, and for a block also with the period.
   subroutine take_sized(rows, numbers, wall, row, error, T_s)
      type(rows_t), intent(in) :: rows
      real(dp), intent(in) :: numbers(:)
      !! values of the other keys that vary
      type(wall_t), intent(in) :: wall
      !! wall with the new size
      type(case_t), intent(inout) :: row
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: T_s
      !! period of a block, 2 pi/p [s]; absent: its size is that of `wall`
      type(wall_t) :: scaled

      call change_case(rows%case, rows%changes, [numbers, real([wall%h, wall%b], dp)], row, error)
      if (allocated(error) .or. allocated(rows%case%frame) .or. .not. present(T_s)) return
      scaled = wall
      call scale_to_period(scaled, row%model%g, T_s)
      call change_case(rows%case, rows%changes, [numbers, real([scaled%h, scaled%b], dp)], row, &
         error)
   end subroutine take_sized

   !> Construct the case of a table row.
   subroutine take_line(rows, x, row, error)
      type(rows_t), intent(in) :: rows
      real(wp), intent(in) :: x(:)
      !! (columns)
      type(case_t), intent(inout) :: row
      type(error_t), allocatable, intent(out) :: error
      type(wall_t) :: wall
      real(wp), allocatable :: T_s
      integer :: axis

      do axis = 1, size(axes)
         if (rows%axis_column(axis) == 0) cycle
         associate (value => x(rows%axis_column(axis)))
            if (is_allowed(rows%case, axis, value)) cycle
            call fail(error, err_input, trim(axes(axis))//' = '//trim(real_to_text(value)) &
               //': must be a finite number'//trim(merge('    ', ' > 0', axis == axis_scale)))
            return
         end associate
      end do
      if (rows%is_sized) then
         ! dimensions without a column keep the values of the case
         wall = rows%case%wall
         if (rows%size_columns(1) > 0) wall%h = x(rows%size_columns(1))
         if (rows%size_columns(2) > 0) wall%b = x(rows%size_columns(2))
         if (rows%axis_column(axis_width) > 0) wall%b = x(rows%axis_column(axis_width))
         if (rows%axis_column(axis_period) > 0) T_s = x(rows%axis_column(axis_period))
         ! an unallocated T_s is an absent argument
         call take_sized(rows, real(x(rows%key_columns), dp), wall, row, error, T_s)
         if (allocated(error)) return
      else if (size(rows%key_columns) > 0) then
         call change_case(rows%case, rows%changes, real(x(rows%key_columns), dp), row, error)
         if (allocated(error)) return
      else
         row%structure_t = rows%case%structure_t
         row%solver = rows%case%solver
         if (rows%has_own_motion) then
            ! the description of the motion, without the samples of its records
            row%motion = rows%case%motion
            if (allocated(rows%case%upward_record)) then
               if (.not. allocated(row%upward_record)) allocate (row%upward_record)
               row%upward_record%factor = rows%case%upward_record%factor
            end if
         end if
      end if
      do axis = 1, size(axes)
         if (rows%axis_column(axis) == 0) cycle
         associate (value => x(rows%axis_column(axis)))
            select case (axes(axis))
            case ('b')
               call set_axes(row, b=value)
            case ('gamma')
               call set_axes(row, gamma=value)
            case ('T_s')
               ! the period of a block has already set its size
               if (.not. rows%is_sized .or. allocated(row%frame)) call set_axes(row, T_s=value)
            case default
               call scale_motion(rows%case, value, row, error)
               if (allocated(error)) return
            end select
         end associate
      end do
   end subroutine take_line

   !> True if an axis allows a value. A frame may be massless; storeys need mass.
   pure logical function is_allowed(case, axis, value)
      type(case_t), intent(in) :: case
      integer, intent(in) :: axis
      real(wp), intent(in) :: value

      is_allowed = ieee_is_finite(value)
      if (.not. is_allowed .or. axis == axis_scale) return
      is_allowed = value > 0 .or. (axes(axis) == 'gamma' .and. value >= 0 &
         .and. .not. has_floors(case))
   end function is_allowed

   !> Apply a factor to the horizontal motion: to the scale of a record or the size of a pulse.
   subroutine scale_motion(case, factor, row, error)
      type(case_t), intent(in) :: case
      !! source of the row
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
         row%record%unit = case%record%unit
         row%motion%scale = factor*row%motion%scale
         call set_factor(row%record, row%motion%scale, row%model%g, error)
      else
         row%record%factor = factor*case%record%factor
      end if
   end subroutine scale_motion

   !> Motion of a row with a separate motion.
   function row_motion(rows, row) result(motion)
      type(rows_t), intent(in) :: rows
      type(case_t), intent(in) :: row
      !! case from `take_row`
      type(motion_t) :: motion

      motion = motion_from_case(row, rows%origin)
   end function row_motion

end module rwmf_spectrum_rows
