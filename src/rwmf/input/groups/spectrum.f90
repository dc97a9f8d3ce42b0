!> Group of the grid of periods, mass ratios and widths, `&spectrum`.
module rwmf_input_groups_spectrum
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t
   use rwmf_problem_case_group, only: case_group_t
   use rwmf_problem_group_values, only: get_list, get_real, get_texts, group_values_t, has_group, &
      has_key, integer_of, real_of, text_of
   use rwmf_problem_key, only: not_negative, optional_key, positive, unless, usually
   use rwmf_problem_rules, only: fail_group, fail_key
   use rwmf_problem_quantity_table, only: all_quantities, canonical_key, is_of_ordinate, is_peak, &
      key_length, look_up, own_key
   use rwmf_simulation_quantity_words, only: meant_quantity, suggest_quantity
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: spectrum_group

contains

   !> Group `&spectrum` with its keys and hooks.
   type(case_group_t) function spectrum_group() result(group)
      group%name = 'spectrum'
      group%is_of_scene = .false.
      group%keys = [ &
         usually('[0.005, 30]', optional_key('spectrum', 'T_s', 'real list', 's', '', positive, &
            'periods one by one (block: 2 pi/p); otherwise T_s_min, T_s_max and n are required')), &
         usually('[0.005, 30]', &
            optional_key('spectrum', 'T_s_min', 'real', 's', '', positive, 'shortest period')), &
         usually('[0.005, 30]', &
            optional_key('spectrum', 'T_s_max', 'real', 's', '', positive, 'longest period')), &
         optional_key('spectrum', 'n', 'integer', '', '', '[1, 1000000]', &
            'number of periods, both ends included'), &
         unless('spectrum.T_s', &
            optional_key('spectrum', 'spacing', 'choice', '', 'linear', 'linear log', &
            'spacing of the periods')), &
         usually('[0.01, 1e5]', &
            optional_key('spectrum', 'gamma', 'real list', '-', '', not_negative, &
            'mass ratios; absent: that of the case')), &
         usually('[0.05, 20]', optional_key('spectrum', 'b', 'real list', 'm', '', positive, &
            'half widths; absent: that of &wall')), &
         optional_key('spectrum', 'quantities', 'text list', '', '', 'see outputs.md', &
            'keys of what each ordinate reports; absent: u_s_max_m, of a block ' &
            //'theta_max_over_alpha')]
      group%check => check_spectrum
      group%fill => fill_spectrum
   end function spectrum_group

   !> Check scene, quantities and periods; the periods are given as a list or as a grid.
   subroutine check_spectrum(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: shortest, longest

      if (.not. has_group(values, 'spectrum')) return
      call check_scene(values, error)
      if (.not. allocated(error)) call check_quantities(values, error)
      if (.not. allocated(error)) call check_grid_keys(values, error)
      if (.not. (allocated(error) .or. has_key(values, 'spectrum', 'T_s'))) then
         ! check the order of the ends, and that different ends have at least two periods
         shortest = real_of(values, 'spectrum', 'T_s_min')
         longest = real_of(values, 'spectrum', 'T_s_max')
         if (longest < shortest) then
            call fail_key(values, 'spectrum', 'T_s_max', 'must be >= T_s_min = '//trim( &
               real_to_text(shortest))//' [s]', error)
         else if (integer_of(values, 'spectrum', 'n') == 1 .and. longest > shortest) then
            call fail_key(values, 'spectrum', 'n', 'must be >= 2 when T_s_min and T_s_max differ', &
               error)
         end if
      end if
   end subroutine check_spectrum

   !> Check that the scene has the period, the mass ratios and the widths that the spectrum varies.
   subroutine check_scene(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(5), parameter :: lists(2) = ['gamma', 'b    ']
      integer :: i

      if (has_group(values, 'frame')) then
         if (has_group(values, 'wall')) return
         do i = 1, size(lists)
            if (.not. has_key(values, 'spectrum', trim(lists(i)))) cycle
            call fail_key(values, 'spectrum', trim(lists(i)), 'must not be given without &wall ' &
               //'(the bare frame does not depend on it)', error)
            return
         end do
      else if (text_of(values, 'wall', 'base') == 'pinned') then
         call fail_group(values, 'spectrum', "must not be given without &frame when &wall base = " &
            //"'pinned' (its periods are those of the frame, or 2 pi/p of a wall that rocks)", &
            error)
      else if (has_key(values, 'spectrum', 'gamma')) then
         call fail_key(values, 'spectrum', 'gamma', 'must not be given without &frame (a ' &
            //'free-standing block has no mass ratio)', error)
      end if
   end subroutine check_scene

   !> Check that all quantities are known and given once.
   subroutine check_quantities(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: request(:)
      character(:), allocatable :: problem
      character(key_length) :: key
      integer :: place, storey
      integer :: i

      call get_texts(values, 'spectrum', 'quantities', request)
      if (.not. allocated(request)) return
      do i = 1, size(request)
         key = canonical_key(request(i))
         call look_up(trim(own_key(key)), place, storey)
         if (place > 0) then
            if (.not. is_of_ordinate(all_quantities(place)) .or. (own_key(key) /= key .and. .not. &
               is_peak(all_quantities(place)))) place = 0
         end if
         if (place == 0) then
            problem = trim(request(i))//' is unknown'
            call suggest_quantity(meant_quantity(trim(request(i))), problem)
            call fail_key(values, 'spectrum', 'quantities', problem, error)
         else if (any(canonical_key(request(:i - 1)) == canonical_key(request(i)))) then
            call fail_key(values, 'spectrum', 'quantities', trim(request(i))//' is given twice', &
               error)
         end if
         if (allocated(error)) return
      end do
   end subroutine check_quantities

   !> Check that all keys of the grid are given, or none with a list of periods.
   subroutine check_grid_keys(values, error)
      type(group_values_t), intent(in) :: values
      type(error_t), allocatable, intent(out) :: error
      character(7), parameter :: grid(4) = ['T_s_min', 'T_s_max', 'n      ', 'spacing']
      integer, parameter :: needed = 3
      logical :: has_list
      integer :: i

      has_list = has_key(values, 'spectrum', 'T_s')
      do i = 1, size(grid)
         if (has_list .and. has_key(values, 'spectrum', trim(grid(i)))) then
            call fail_key(values, 'spectrum', trim(grid(i)), 'must not be given beside the ' &
               //'list T_s', error)
         else if (.not. has_list .and. .not. has_key(values, 'spectrum', trim(grid(i))) &
                  .and. i <= needed) then
            call fail_group(values, 'spectrum', 'the key '//trim(grid(i))//' is missing: must be ' &
               //'given without the list T_s', error)
         end if
         if (allocated(error)) return
      end do
   end subroutine check_grid_keys

   subroutine fill_spectrum(case, error)
      type(case_t), intent(inout) :: case
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: request(:)

      allocate (case%spectrum)
      call get_texts(case%values, 'spectrum', 'quantities', request)
      if (allocated(request)) then
         allocate (character(key_length) :: case%spectrum%quantities(size(request)))
         case%spectrum%quantities(:) = canonical_key(request)
      end if
      call get_list(case%values, 'spectrum', 'gamma', case%spectrum%gamma)
      call get_list(case%values, 'spectrum', 'b', case%spectrum%b)
      call get_list(case%values, 'spectrum', 'T_s', case%spectrum%T_s)
      if (allocated(case%spectrum%T_s)) return
      call get_real(case%values, 'spectrum', 'T_s_min', case%spectrum%T_s_min)
      call get_real(case%values, 'spectrum', 'T_s_max', case%spectrum%T_s_max)
      case%spectrum%n = integer_of(case%values, 'spectrum', 'n')
      case%spectrum%spacing = text_of(case%values, 'spectrum', 'spacing')
   end subroutine fill_spectrum

end module rwmf_input_groups_spectrum
