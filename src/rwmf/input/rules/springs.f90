!> Rules of the springs with memory: a tendon that yields or breaks, a yielding frame.
module rwmf_input_rules_springs
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: pi, wp
   use rwmf_input_group_values, only: get_list, has_group, has_key, real_of, text_of
   use rwmf_input_namelist, only: group_t
   use rwmf_input_rules_common, only: check_one_of, fail_group, fail_key, too_stiff
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: check_fuse, check_tendon, check_yielding

contains

   !> One measure of the frame's strength. With a short link its displacement turns back at a large
   !> rotation; its spring follows the rotation only as long as both grow together.
   subroutine check_yielding(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: limit

      if (.not. has_group(groups, 'yielding')) return
      if (yields_by_storey(groups)) then
         call check_storey_strengths(groups, error)
      else
         call check_one_of(groups, 'yielding', 'u_y', 'f_y_over_m_s_g', 'as the strength', error)
      end if
      if (allocated(error) .or. .not. has_group(groups, 'link')) return
      if (text_of(groups, 'model', 'formulation') /= 'exact' &
          .and. text_of(groups, 'wall', 'base') /= 'pinned') return
      if (has_group(groups, 'storeys')) then
         ! storeys of a frame with all its modes do not follow the rotation
         if (text_of(groups, 'storeys', 'coupling') == 'full') return
      end if
      limit = turning_rotation(real_of(groups, 'wall', 'h'), real_of(groups, 'link', 'L'))
      if (real_of(groups, 'model', 'overturning_angle') <= limit) return
      call fail_key(groups, 'link', 'L', 'needs &model overturning_angle <= '//real_to_text(limit) &
         //' rad with &yielding: at larger rotations the frame turns back while the wall goes on', &
         error)
   end subroutine check_yielding

   !> Is the strength that of single storeys, as given or because no other can be meant?
   pure logical function yields_by_storey(groups)
      type(group_t), intent(in) :: groups(:)

      yields_by_storey = has_key(groups, 'yielding', 'storey_u_y')
      if (has_group(groups, 'storeys')) yields_by_storey = yields_by_storey &
         .or. text_of(groups, 'storeys', 'coupling') == 'full'
   end function yields_by_storey

   !> Storeys that yield one by one: which frames have them, and how many there are.
   subroutine check_storey_strengths(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(14), parameter :: keys(2) = [character(14) :: 'u_y', 'f_y_over_m_s_g']
      character(:), allocatable :: coupling
      real(wp), allocatable :: m(:)
      real(wp), allocatable :: u_y(:)
      integer :: i

      coupling = ''
      if (has_group(groups, 'storeys')) coupling = text_of(groups, 'storeys', 'coupling')
      if (coupling /= 'full' .and. coupling /= 'every_floor') then
         call fail_key(groups, 'yielding', 'storey_u_y', "must not be given without &storeys " &
            //"coupling = 'full' or 'every_floor': other frames yield as one spring, u_y", error)
         return
      end if
      do i = 1, size(keys)
         if (.not. has_key(groups, 'yielding', trim(keys(i)))) cycle
         call fail_key(groups, 'yielding', trim(keys(i)), "must not be given where the storeys " &
            //"yield one by one (&storeys coupling = 'full', or storey_u_y): storey_u_y says " &
            //'when', error)
         return
      end do
      if (.not. has_key(groups, 'yielding', 'storey_u_y')) then
         call fail_group(groups, 'yielding', "the key storey_u_y is missing (u_i - u_(i-1) at " &
            //"first yield): must be given with &storeys coupling = 'full', numbers > 0 [m]", error)
         return
      end if
      call get_list(groups, 'storeys', 'm_over_m_w', m)
      call get_list(groups, 'yielding', 'storey_u_y', u_y)
      if (size(u_y) /= 1 .and. size(u_y) /= size(m)) then
         call fail_key(groups, 'yielding', 'storey_u_y', 'has '//integer_to_text(size(u_y)) &
            //' values, must have one for all storeys or one for each of the ' &
            //integer_to_text(size(m))//' of m_over_m_w', error)
      else if (text_of(groups, 'yielding', 'law') == 'bouc_wen' .and. coupling /= 'full') then
         call fail_key(groups, 'yielding', 'law', "must be 'elastic_plastic' with storey_u_y and " &
            //"&storeys coupling = 'every_floor'; coupling = 'full' allows both", error)
      end if
   end subroutine check_storey_strengths

   !> The stiffness of a fuse must leave the wall a period that can be followed.
   subroutine check_fuse(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem

      if (.not. has_group(groups, 'fuse')) return
      problem = too_stiff(sqrt(real_of(groups, 'fuse', 'stroke_y')), &
         sqrt(real_of(groups, 'fuse', 'eta_y'))*sqrt(real_of(groups, 'model', 'g')))
      if (len(problem) == 0) return
      call fail_key(groups, 'fuse', 'stroke_y', problem//', eta_y m_w g/stroke_y', error)
   end subroutine check_fuse

   !> Rotation to the left at which the displacement of the link's far end is largest, by
   !> bisection: u = 2h sin(phi) - (L - sqrt(L**2 - v**2)), v = 2h (1 - cos(phi)) [rad].
   pure real(wp) function turning_rotation(h, L) result(low)
      real(wp), intent(in) :: h
      !! half height [m]
      real(wp), intent(in) :: L
      !! length of the link [m]
      real(wp) :: high
      real(wp) :: middle
      real(wp) :: v

      low = 0
      high = pi/2
      do
         middle = low + (high - low)/2
         if (middle <= low .or. middle >= high) return
         v = 4*h*sin(middle/2)**2
         if (v < L .and. cos(middle)*sqrt(max(0.0_wp, L**2 - v**2)) > v*sin(middle)) then
            low = middle
         else
            high = middle
         end if
      end do
   end function turning_rotation

   !> A cable that yields or breaks: elongations need a stiffness, and it must not begin beyond its
   !> limits.
   subroutine check_tendon(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(14) :: key
      real(wp) :: eta_0

      key = 'eta_y'
      if (.not. has_key(groups, 'cable', 'eta_y')) key = 'rupture_strain'
      eta_0 = real_of(groups, 'cable', 'eta_0')
      if (text_of(groups, 'model', 'formulation') == 'published') then
         call fail_key(groups, 'cable', trim(key), "must not be given with &model formulation = " &
            //"'published' (its default), where the force falls with rocking to one side; " &
            //"'symmetric' and 'exact' allow it", error)
      else if (real_of(groups, 'cable', 'eta_alpha') <= eta_0) then
         call fail_key(groups, 'cable', trim(key), 'needs eta_alpha > eta_0 = ' &
            //real_to_text(eta_0)//', which says how stiff the cable is', error)
      else if (has_key(groups, 'cable', 'hardening') .and. key /= 'eta_y') then
         call fail_key(groups, 'cable', 'hardening', 'must not be given without eta_y', error)
      else if (has_key(groups, 'cable', 'eta_y')) then
         if (real_of(groups, 'cable', 'eta_y') <= eta_0) then
            call fail_key(groups, 'cable', 'eta_y', 'must be > eta_0 = '//real_to_text(eta_0), &
               error)
         end if
      end if
      if (.not. allocated(error)) call check_tendon_stiffness(groups, error)
      if (allocated(error) .or. .not. has_key(groups, 'cable', 'rupture_strain')) return
      call check_strain(groups, eta_0, error)
   end subroutine check_tendon

   !> The stiffness of the tendon must leave the wall a period that can be followed, for any width
   !> of the spectrum.
   subroutine check_tendon_stiffness(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problem
      real(wp), allocatable :: b(:)
      real(wp) :: shortest
      !! elongation up to theta = alpha [m]
      integer :: i

      b = widths(groups)
      shortest = huge(shortest)
      do i = 1, size(b)
         shortest = min(shortest, elongation_at_alpha(text_of(groups, 'cable', 'law'), &
            real_of(groups, 'wall', 'h'), b(i)))
      end do
      problem = too_stiff(sqrt(shortest), sqrt(real_of(groups, 'cable', 'eta_alpha') &
         - real_of(groups, 'cable', 'eta_0'))*sqrt(real_of(groups, 'model', 'g')))
      if (len(problem) > 0) call fail_key(groups, 'cable', 'eta_alpha', problem, error)
   end subroutine check_tendon_stiffness

   !> Half widths of the wall in a run or a spectrum [m].
   function widths(groups) result(b)
      type(group_t), intent(in) :: groups(:)
      real(wp), allocatable :: b(:)

      call get_list(groups, 'spectrum', 'b', b)
      if (.not. allocated(b)) b = [real_of(groups, 'wall', 'b')]
   end function widths

   !> The prestress alone must not break the cable, for any width of the spectrum.
   subroutine check_strain(groups, eta_0, error)
      type(group_t), intent(in) :: groups(:)
      real(wp), intent(in) :: eta_0
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: b(:)
      real(wp) :: h
      real(wp) :: strain
      integer :: i

      h = real_of(groups, 'wall', 'h')
      b = widths(groups)
      strain = 0
      do i = 1, size(b)
         strain = max(strain, eta_0/(2*h)*elongation_at_alpha(text_of(groups, 'cable', 'law'), h, &
            b(i))/(real_of(groups, 'cable', 'eta_alpha') - eta_0))
      end do
      if (real_of(groups, 'cable', 'rupture_strain') > strain) return
      call fail_key(groups, 'cable', 'rupture_strain', 'must be > '//real_to_text(strain) &
         //', the strain of the prestress', error)
   end subroutine check_strain

   !> Elongation of the cable at theta = alpha: b alpha for Eq. (1), else that of a straight cable
   !> [m].
   pure real(wp) function elongation_at_alpha(law, h, b) result(elongation)
      character(*), intent(in) :: law
      real(wp), intent(in) :: h
      !! half height [m]
      real(wp), intent(in) :: b
      !! half width [m]
      real(wp) :: alpha

      alpha = atan2(b, h)
      elongation = b*alpha
      if (law == 'truss') then
         elongation = sqrt(4*h**2 + 2*b**2*(1 - cos(alpha)) + 4*h*b*sin(alpha)) - 2*h
      end if
   end function elongation_at_alpha

end module rwmf_input_rules_springs
